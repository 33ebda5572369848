#include <rubato/results/variable_names.hpp>

#include <set>

namespace rubato::results {

std::vector<std::string> variable_names(const TableLayout& layout) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Block& block : layout.blocks) {
    names.push_back(block.variable);
    if (block.width() == 0) continue;
    if (!block.dimension.empty()) taken.insert(block.dimension);  // the variable of its labels
    if (taken.contains(block.variable)) names.back() = block.dimension + "_" + block.variable;
    taken.insert(names.back());
  }
  return names;
}

}  // namespace rubato::results
