#include "study.hpp"

#include <rubato/core/error.hpp>
#include <rubato/core/version.hpp>
#include <rubato/io/schema.hpp>
#include <rubato/results/variable_names.hpp>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace rubato::python {
namespace {

/// Raises an exception of the package: a class of rubato/errors.py.
void raise(const char* type, const std::string& message) {
  const py::object kind = py::module_::import("rubato.errors").attr(type);
  PyErr_SetString(kind.ptr(), message.c_str());
}

void raise_study_error(const InvalidInput& fault) {
  const py::object kind = py::module_::import("rubato.errors").attr("StudyError");
  const Location& where = fault.where();
  const auto number = [](int value) { return value > 0 ? py::object(py::int_(value)) : py::object(py::none()); };
  const py::object error =
      kind(fault.message(), py::arg("file") = where.file.empty() ? py::object(py::none()) : py::str(where.file),
           py::arg("line") = number(where.line), py::arg("column") = number(where.column));
  PyErr_SetObject(kind.ptr(), error.ptr());
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const InvalidInput& fault) {
    raise_study_error(fault);
  } catch (const OutputError& fault) {
    raise("OutputError", fault.what());
  } catch (const py::error_already_set&) {
    throw;
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::runtime_error& fault) {
    raise("Error", fault.what());
  }
}

/// The values of a block where they are: [rows], or [rows x labels]. The array keeps the table alive. It is read-only:
/// a report that is written later shows what was computed.
py::array_t<double> array_of(const std::shared_ptr<results::MemoryTable>& table, std::size_t block) {
  auto owner = std::make_unique<std::shared_ptr<results::MemoryTable>>(table);
  const py::capsule base(owner.get(),
                         [](void* kept) { delete static_cast<std::shared_ptr<results::MemoryTable>*>(kept); });
  (void)owner.release();
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(table->rows)};
  const auto& laid = table->layout.blocks[block];
  if (!laid.dimension.empty()) shape.push_back(static_cast<py::ssize_t>(laid.width()));
  py::array_t<double> values(shape, table->values[block].data(), base);
  values.attr("flags").attr("writeable") = false;
  return values;
}

py::dict dict_of(const std::vector<std::pair<std::string, std::string>>& attributes) {
  py::dict result;
  for (const auto& [name, text] : attributes) result[py::str(name)] = text;
  return result;
}

py::list blocks_of(const std::shared_ptr<results::MemoryTable>& table) {
  py::list blocks;
  const auto names = results::variable_names(table->layout);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const results::Block& block = table->layout.blocks[i];
    if (block.width() == 0) continue;
    blocks.append(py::make_tuple(names[i], block.unit, block.description, block.dimension, block.labels,
                                 block.categories, array_of(table, i)));
  }
  return blocks;
}

py::list tables_of(const results::MemoryAnalysis& analysis) {
  py::list tables;
  for (const auto& table : analysis.tables)
    tables.append(py::make_tuple(table->layout.table, table->layout.row_dimension, dict_of(table->layout.attributes),
                                 blocks_of(table)));
  return tables;
}

py::list analyses_of(const Run& run) {
  py::list analyses;
  for (const auto& one : run.analyses())
    analyses.append(py::make_tuple(one.name, one.status, one.message, dict_of(one.attributes), tables_of(one)));
  return analyses;
}

py::dict outline_of(const Run& run) {
  const Outline& outline = run.outline();
  py::dict parameters;
  for (const auto& [name, value] : outline.parameters) parameters[py::str(name)] = value;
  py::list analyses;
  for (const auto& one : outline.analyses) analyses.append(py::make_tuple(one.name, one.summary, one.warnings));
  using namespace py::literals;
  return py::dict("title"_a = outline.title, "summary"_a = outline.summary, "facts"_a = outline.facts,
                  "doubts"_a = outline.doubts, "parameters"_a = parameters, "analyses"_a = analyses);
}

py::list progress_of(const Run& run) {
  py::list all;
  for (const auto& one : run.progress()) all.append(py::make_tuple(one.analysis, one.done, one.total, one.unit));
  return all;
}

std::vector<std::string> names_of(const Study& study) {
  std::vector<std::string> names;
  for (const auto& analysis : study.description->analyses) names.push_back(analysis.name);
  return names;
}

/// A run may go on for a while where Python drops it: nobody else is to wait for that.
void release_run(Run* run) {
  const py::gil_scoped_release others;
  delete run;
}
struct RunDeleter {
  void operator()(Run* run) const { release_run(run); }
};

}  // namespace
}  // namespace rubato::python

PYBIND11_MODULE(_rubato, module) {
  using namespace rubato;
  using namespace rubato::python;
  const auto free = py::call_guard<py::gil_scoped_release>();
  module.doc() = "The library behind the package rubato. Call that instead.";
  module.attr("version") = version;
  py::register_local_exception_translator(translate);
  module.def("schema", &io::study_schema);
  module.def("suggestion",
             [](const std::string& name, const std::vector<std::string>& known) { return suggestion(name, known); });

  py::class_<Study>(module, "Study")
      .def_static("read", &read_study, py::arg("file"), free)
      .def_static("from_text", &read_study_text, py::arg("text"), py::arg("name"), py::arg("folder"), free)
      .def_property_readonly("title", [](const Study& study) { return study.description->title; })
      .def_property_readonly("file", [](const Study& study) { return study.description->file; })
      .def_property_readonly("text", [](const Study& study) { return study.description->text; })
      .def_property_readonly("folder", [](const Study& study) { return study.folder; })
      .def_property_readonly("analyses", &names_of)
      .def("parameters", [](const Study& study) {
        py::dict values;
        for (const auto& [name, value] : model::evaluate_parameters(study.description->parameters))
          values[py::str(name)] = value;
        return values;
      });

  py::class_<Run, std::unique_ptr<Run, RunDeleter>>(module, "Run")
      .def(py::init<Study, Settings, std::vector<std::string>, int, bool>(), py::arg("study"), py::arg("settings"),
           py::arg("only"), py::arg("jobs"), py::arg("checks_only"))
      .def("wait", &Run::wait, py::arg("seconds"), free)
      .def("stop", &Run::stop)
      .def("require_success", &Run::require_success)
      .def("progress", &progress_of)
      .def("outline", &outline_of)
      .def("analyses", &analyses_of)
      .def("warnings", &Run::warnings)
      .def("write", &Run::write, py::arg("folder"), py::arg("command"), free)
      .def("write_report", &Run::write_report, py::arg("page"), py::arg("command"), free);
}
