#include <rubato/core/excerpt.hpp>
#include <rubato/io/finite_elements/read_inp_mesh.hpp>
#include <rubato/io/finite_elements/text_scanner.hpp>
#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <unordered_map>

namespace rubato::io {
namespace {

constexpr std::uintmax_t largest_mesh = std::uintmax_t{4} << 30;
constexpr int deepest_include = 10;

std::string upper(std::string_view text) {
  std::string word(trimmed_blanks(text));
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::toupper(c); });
  if (word.size() > 1 && word.front() == '"' && word.back() == '"') word = word.substr(1, word.size() - 2);
  return word;
}

void split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  while (true) {
    const std::size_t comma = std::min(line.find(','), line.size());
    fields.push_back(trimmed_blanks(line.substr(0, comma)));
    if (comma == line.size()) return;
    line.remove_prefix(comma + 1);
  }
}

/// A line that begins with one asterisk: a keyword and its parameters.
struct Keyword {
  std::string name;
  std::map<std::string, std::string> parameters;  // in capitals but for INPUT

  explicit Keyword(std::string_view line) {
    std::vector<std::string_view> fields;
    split(line.substr(1), fields);
    name = upper(fields[0]);
    for (std::size_t i = 1; i < fields.size(); ++i) {
      const std::size_t equals = fields[i].find('=');
      const std::string key = upper(fields[i].substr(0, equals));
      const std::string_view value =
          equals == std::string_view::npos ? std::string_view() : trimmed_blanks(fields[i].substr(equals + 1));
      parameters[key] = key == "INPUT" ? std::string(value) : upper(value);
    }
  }
  std::string parameter(const std::string& key) const {
    const auto found = parameters.find(key);
    return found == parameters.end() ? "" : found->second;
  }
};

/// Nodes of the elements whose number is sure: others may have any.
std::size_t node_count(const std::string& type) {
  static const std::vector<std::pair<const char*, std::size_t>> counts{{"C3D20", 20}, {"C3D15", 15}, {"C3D10", 10},
                                                                       {"C3D8", 8},   {"C3D6", 6},   {"C3D4", 4}};
  for (const auto& [name, count] : counts)
    if (type.starts_with(name)) return count;
  return 0;
}

class InpReader {
 public:
  InpReader(const StudyFolder& folder, model::Mesh& mesh) : folder_(folder), mesh_(mesh) {}

  void read(const std::string& file, const Location& where, int depth) {
    const std::string text = folder_.read(file, where, largest_mesh, "the mesh");
    const std::string place = folder_.place_of(file);
    refuse_binary(text, place, "a mesh is an input deck of CalculiX or Abaqus (.inp), which is text");
    LineScanner lines(text, place);
    std::string_view line;
    while (lines.next(line)) {
      line = trimmed_blanks(line);
      if (line.empty() || line.starts_with("**")) continue;
      here_ = lines.here();
      if (line.front() != '*') {
        take_data(line);
        continue;
      }
      finish_element();
      const Keyword keyword(line);
      if (keyword.name == "INCLUDE") {
        section_ = Section::other;
        include(keyword, file, depth);
      } else {
        begin(keyword);
      }
    }
    finish_element();
  }

  void finish(const std::string& file) {
    sort_nodes(file);
    place_elements();
    require_nodes_of_sets();
  }

 private:
  enum class Section { other, node, element, set, elastic, density };

  void include(const Keyword& keyword, const std::string& file, int depth) {
    std::string input = keyword.parameter("INPUT");
    std::erase(input, '"');
    if (input.empty()) throw InvalidInput(here_, "*INCLUDE does not tell INPUT=");
    if (depth >= deepest_include)
      throw InvalidInput(here_, fmt::format("*INCLUDE goes {} files deep: does a file include itself?", depth));
    const Location where = here_;
    read((std::filesystem::path(file).parent_path() / input).string(), where, depth + 1);
    section_ = Section::other;
  }

  void begin(const Keyword& keyword) {
    static const std::vector<std::string> refused{"PART",  "INSTANCE", "ASSEMBLY", "SYSTEM", "NGEN",
                                                  "NFILL", "NCOPY",    "NMAP",     "ELGEN",  "ELCOPY"};
    if (std::find(refused.begin(), refused.end(), keyword.name) != refused.end())
      throw InvalidInput(here_,
                         fmt::format("*{} is not read: it gives nodes or elements other numbers or places than the "
                                     "deck has; write a flat deck, without parts, assemblies, systems and generated "
                                     "nodes, with the numbers that the matrices have",
                                     keyword.name));
    static const std::vector<std::string> ties{"EQUATION",
                                               "TIE",
                                               "MPC",
                                               "RIGID BODY",
                                               "COUPLING",
                                               "KINEMATIC",
                                               "DISTRIBUTING",
                                               "KINEMATIC COUPLING",
                                               "RIGIDBODY",
                                               "CYCLIC SYMMETRY MODEL",
                                               "DISTRIBUTING COUPLING"};
    if (mesh_.tie.empty() && std::find(ties.begin(), ties.end(), keyword.name) != ties.end()) {
      mesh_.tie = keyword.name;
      mesh_.tie_where = here_;
    }
    section_ = Section::other;
    const auto refuse_input = [&] {
      if (!keyword.parameter("INPUT").empty())
        throw InvalidInput(here_, fmt::format("*{} with INPUT= is not read; take *INCLUDE", keyword.name));
    };
    if (keyword.name == "NODE") {
      refuse_input();
      if (const std::string system = keyword.parameter("SYSTEM"); !system.empty() && system != "R")
        throw InvalidInput(here_, "*NODE, SYSTEM= is not read: positions must be rectangular");
      section_ = Section::node;
      set_ = nullptr;
      if (const std::string name = keyword.parameter("NSET"); !name.empty()) set_ = &set_called(name);
    } else if (keyword.name == "ELEMENT") {
      refuse_input();
      section_ = Section::element;
      type_ = keyword.parameter("TYPE");
      if (type_.empty()) throw InvalidInput(here_, "*ELEMENT does not tell TYPE=");
    } else if (keyword.name == "NSET") {
      const std::string name = keyword.parameter("NSET");
      if (name.empty()) throw InvalidInput(here_, "*NSET does not tell NSET=");
      // Sets by elements are passed over: who names them is told that they are unknown.
      if (!keyword.parameter("ELSET").empty()) return;
      section_ = Section::set;
      set_ = &set_called(name);
      generates_ = keyword.parameters.count("GENERATE") > 0;
    } else if (keyword.name == "MATERIAL") {
      mesh_.materials.push_back({keyword.parameter("NAME"), {}, {}, here_});
    } else if (!mesh_.materials.empty() && keyword.name == "ELASTIC") {
      const std::string type = keyword.parameter("TYPE");
      if (type.empty() || type == "ISO" || type == "ISOTROPIC") section_ = Section::elastic;
    } else if (!mesh_.materials.empty() && keyword.name == "DENSITY") {
      section_ = Section::density;
    }
  }

  void take_data(std::string_view line) {
    if (section_ == Section::other) return;
    split(line, fields_);
    switch (section_) {
      case Section::node:
        return take_node();
      case Section::element:
        return take_element(line);
      case Section::set:
        return take_set();
      default:
        return take_property();
    }
  }

  std::int64_t whole(std::string_view field, const char* what) const {
    std::int64_t number = 0;
    const auto [end, fault] = std::from_chars(field.data(), field.data() + field.size(), number);
    if (fault != std::errc() || end != field.data() + field.size() || number < 1)
      throw InvalidInput(here_, fmt::format("{} must be a whole number from 1 on, got \"{}\"", what, excerpt(field)));
    return number;
  }

  void take_node() {
    const std::int64_t number = whole(fields_[0], "the number of a node");
    std::array<double, 3> position{};
    for (std::size_t i = 0; i < 3 && i + 1 < fields_.size(); ++i) {
      if (fields_[i + 1].empty()) continue;
      if (!fortran_number(fields_[i + 1], position[i]) || !std::isfinite(position[i]))
        throw InvalidInput(here_, fmt::format("the place of node {} must be three finite numbers, got \"{}\"", number,
                                              excerpt(fields_[i + 1])));
    }
    const auto [found, is_new] = positions_.emplace(number, position);
    if (!is_new && found->second != position)
      throw InvalidInput(here_, fmt::format("node {} is given twice, at different places", number));
    if (is_new) mesh_.nodes.push_back(number);
    if (set_) add(*set_, number);
  }

  void take_element(std::string_view line) {
    std::size_t first = 0;
    if (!is_open_) {
      mesh_.elements.push_back({whole(fields_[0], "the number of an element"), type_, numbers_.size(), 0});
      element_where_ = here_;
      first = 1;
    }
    for (std::size_t i = first; i < fields_.size(); ++i)
      if (!fields_[i].empty()) {
        numbers_.push_back(whole(fields_[i], "a node of an element"));
        ++mesh_.elements.back().count;
      }
    is_open_ = line.back() == ',';
    if (!is_open_) finish_element();
  }

  void finish_element() {
    if (section_ != Section::element || mesh_.elements.empty()) return;
    is_open_ = false;
    const model::MeshElement& element = mesh_.elements.back();
    const std::size_t wanted = node_count(element.type);
    if (wanted != 0 && element.count != wanted)
      throw InvalidInput(element_where_, fmt::format("element {} of type {} has {} nodes, and needs {}", element.number,
                                                     element.type, element.count, wanted));
  }

  struct Set {
    model::NodeSet set;
    std::vector<Location> where;  ///< of each node, to the file and line
    std::unordered_map<std::int64_t, bool> has;
  };

  Set& set_called(const std::string& name) {
    const auto found = std::find_if(sets_.begin(), sets_.end(), [&](const auto& s) { return s->set.name == name; });
    if (found != sets_.end()) return **found;
    sets_.push_back(std::make_unique<Set>());
    sets_.back()->set.name = name;
    return *sets_.back();
  }

  void add(Set& set, std::int64_t node) const {
    if (!set.has.emplace(node, true).second) return;
    set.set.nodes.push_back(node);
    set.where.push_back(here_);
  }

  void take_set() {
    if (generates_) {
      if (fields_.size() < 2 || fields_.size() > 3)
        throw InvalidInput(here_, "GENERATE takes the first node, the last one and the step between them");
      const std::int64_t first = whole(fields_[0], "a node"), last = whole(fields_[1], "a node");
      const std::int64_t step = fields_.size() > 2 && !fields_[2].empty() ? whole(fields_[2], "the step") : 1;
      if (last < first || (last - first) / step > 100000000)
        throw InvalidInput(here_, fmt::format("GENERATE from {} to {} is no range of nodes", first, last));
      for (std::int64_t node = first; node <= last; node += step)
        if (positions_.count(node) > 0) add(*set_, node);
      return;
    }
    for (const std::string_view field : fields_) {
      if (field.empty()) continue;
      if (std::isdigit(static_cast<unsigned char>(field.front()))) {
        add(*set_, whole(field, "a node"));
        continue;
      }
      const std::string name = upper(field);
      const auto other = std::find_if(sets_.begin(), sets_.end(), [&](const auto& s) { return s->set.name == name; });
      if (other == sets_.end())
        throw InvalidInput(here_, fmt::format("the set \"{}\" takes the nodes of \"{}\", which is no set before it{}",
                                              set_->set.name, name, suggestion(name, set_names())));
      const std::vector<std::int64_t> nodes = (*other)->set.nodes;
      for (const std::int64_t node : nodes) add(*set_, node);
    }
  }

  std::vector<std::string> set_names() const {
    std::vector<std::string> names;
    for (const auto& set : sets_) names.push_back(set->set.name);
    return names;
  }

  /// Of the first line below *ELASTIC or *DENSITY: others are for other temperatures.
  void take_property() {
    double value = 0.0;
    if (!fortran_number(fields_[0], value)) return;
    auto& material = mesh_.materials.back();
    (section_ == Section::elastic ? material.young : material.density) = value;
    section_ = Section::other;
  }

  void sort_nodes(const std::string& file) {
    if (mesh_.nodes.empty())
      throw InvalidInput({folder_.place_of(file), 0, 0}, "the mesh has no nodes: *NODE with a line a node is missing");
    std::sort(mesh_.nodes.begin(), mesh_.nodes.end());
    for (const std::int64_t node : mesh_.nodes) mesh_.positions.push_back(positions_.at(node));
  }

  void place_elements() {
    mesh_.element_nodes.reserve(numbers_.size());
    for (const model::MeshElement& element : mesh_.elements)
      for (std::size_t i = element.first; i < element.first + element.count; ++i) {
        const auto place = mesh_.place_of(numbers_[i]);
        if (!place)
          throw InvalidInput(mesh_.where, fmt::format("element {} of the mesh \"{}\" has node {}, which the mesh does "
                                                      "not have",
                                                      element.number, mesh_.file, numbers_[i]));
        mesh_.element_nodes.push_back(*place);
      }
  }

  void require_nodes_of_sets() {
    for (const auto& set : sets_) {
      for (std::size_t i = 0; i < set->set.nodes.size(); ++i)
        if (positions_.count(set->set.nodes[i]) == 0)
          throw InvalidInput(set->where[i], fmt::format("the set \"{}\" has node {}, which the mesh does not have",
                                                        set->set.name, set->set.nodes[i]));
      mesh_.sets.push_back(std::move(set->set));
    }
  }

  const StudyFolder& folder_;
  model::Mesh& mesh_;
  Location here_, element_where_;
  Section section_ = Section::other;
  std::vector<std::string_view> fields_;
  std::unordered_map<std::int64_t, std::array<double, 3>> positions_;
  std::string type_;
  bool is_open_ = false;
  std::vector<std::int64_t> numbers_;  // nodes of the elements
  std::vector<std::unique_ptr<Set>> sets_;
  Set* set_ = nullptr;
  bool generates_ = false;
};

}  // namespace

model::Mesh read_inp_mesh(const std::string& file, const StudyFolder& folder, const Location& where) {
  model::Mesh mesh;
  mesh.file = file;
  mesh.where = where;
  InpReader reader(folder, mesh);
  reader.read(file, where, 0);
  reader.finish(file);
  return mesh;
}

}  // namespace rubato::io
