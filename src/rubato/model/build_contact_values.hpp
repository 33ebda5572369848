#pragma once

#include <rubato/model/build_parts.hpp>
#include <rubato/model/laws/elastic_contact.hpp>

#include <string>
#include <vector>

// Private to the model floor.
namespace rubato::model {

/// What the keys of a contact say, whatever it joins, with messages that name it.
class ContactReading {
 public:
  /// @param dimension  2 or 3, in which normal_direction is told
  ContactReading(const ContactDescription& description, const numerics::Parameters& parameters, int dimension);

  const std::string& part() const { return part_; }  ///< "contact \"NAME\""
  double number(const Quantity& quantity, const std::string& key) const;
  double positive(const Quantity& quantity, const std::string& key) const;
  /// @param directions  in which it rubs
  ContactValues values(Index directions) const;
  /// The normal n, of length 1.
  Axis normal() const;
  /// The directions along the plane: in the plane e_z x n; in space t1 and n x t1.
  std::vector<Axis> along(const Axis& n) const;

 private:
  Axis direction(const std::vector<Quantity>& given, const char* key, const Location& where) const;

  const ContactDescription& d_;
  const numerics::Parameters& parameters_;
  int dimension_;
  std::string part_;
};

}  // namespace rubato::model
