#pragma once

#include <string_view>

/// The files that the page is made of, embedded in the library when it is built.
namespace rubato::report::assets {

std::string_view plotly();  ///< plotly.js, cartesian bundle, minified
std::string_view script();  ///< assets/*.js, one after another in the order of CMakeLists.txt
std::string_view style();   ///< assets/style.css

}  // namespace rubato::report::assets
