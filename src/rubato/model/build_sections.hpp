#pragma once

#include <rubato/model/by_name.hpp>
#include <rubato/model/structure_description.hpp>

#include <vector>

// Private to the model floor: what beams and trusses are made of, evaluated and checked.
namespace rubato::model {

struct Material {
  double young = 0.0, shear_modulus = 0.0, density = 0.0;  ///< shear_modulus 0: not given [Pa], [Pa], [kg/m3]
  double retardation_time = 0.0;                           ///< [s]
};

/// Zero where it is not given [m2], [m4], [-].
struct Section {
  double area = 0.0, inertia_y = 0.0, inertia_z = 0.0, torsion = 0.0, shear_factor_y = 0.0, shear_factor_z = 0.0;
};

ByName<Material> build_materials(const std::vector<MaterialDescription>& materials,
                                 const numerics::Parameters& parameters);
ByName<Section> build_sections(const std::vector<SectionDescription>& sections, bool in_plane,
                               const numerics::Parameters& parameters);

/// The value of a quantity. Throws InvalidInput where it is not positive.
double positive(const Quantity& quantity, const numerics::Parameters& parameters, const std::string& what);

}  // namespace rubato::model
