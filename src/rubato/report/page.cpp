#include <rubato/report/assets.hpp>
#include <rubato/report/json.hpp>
#include <rubato/report/page.hpp>

#include <algorithm>
#include <cctype>

namespace rubato::report {

std::string inline_script(std::string_view code) {
  constexpr std::string_view closing = "</script";
  const auto is_equal = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  std::string out;
  out.reserve(code.size());
  auto from = code.begin();
  while (true) {
    const auto found = std::search(from, code.end(), closing.begin(), closing.end(), is_equal);
    out.append(from, found);
    if (found == code.end()) return out;
    out += "<\\";
    from = found + 1;
  }
}

std::string html_page(std::string_view title, std::string_view data) {
  std::string out;
  out.reserve(assets::plotly().size() + assets::script().size() + assets::style().size() + data.size() + 4096);
  out +=
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
      "script-src 'unsafe-inline'; img-src data: blob:\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>";
  out += html_text(title);
  out += "</title>\n<style>\n";
  out += assets::style();
  out += "</style>\n</head>\n<body>\n<noscript><p>This report draws its figures with JavaScript, which is off.";
  out += "</p></noscript>\n<div id=\"page\"></div>\n<script type=\"application/json\" id=\"data\">";
  out += data;
  out += "</script>\n<script>";
  out += inline_script(assets::plotly());
  out += "</script>\n<script>\n(() => {\n\"use strict\";\n";
  out += inline_script(assets::script());
  out += "})();\n</script>\n</body>\n</html>\n";
  return out;
}

}  // namespace rubato::report
