#include <rubato/io/reading_visitor.hpp>
#include <rubato/model/fields/model_fields.hpp>

#include <fmt/format.h>

namespace rubato::io {

model::ModelDescription read_model(TomlReader& root, const StudyFolder& folder) {
  for (const auto& type : model::joint_types())
    root.note_elsewhere(type.word, fmt::format("write [[joint]] with type = \"{}\"", type.word));
  root.note_elsewhere("hinge", "write [[joint]] with type = \"revolute\"");
  model::ModelDescription model;
  ReadingVisitor visitor(root, folder);
  fields(visitor, model);
  return model;
}

}  // namespace rubato::io
