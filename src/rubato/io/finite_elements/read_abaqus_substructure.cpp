#include <rubato/core/excerpt.hpp>
#include <rubato/io/finite_elements/matrix_formats.hpp>
#include <rubato/io/finite_elements/text_scanner.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>

// *USER ELEMENT with full matrices, as *SUBSTRUCTURE MATRIX OUTPUT of Abaqus and CalculiX writes it.
namespace rubato::io {
namespace {

/// The numbers of a line with commas; false where something else stands there.
template <class Number>
bool numbers_of(std::string_view line, std::vector<Number>& to) {
  NumberScanner numbers(line);
  while (!numbers.is_at_end()) {
    Number number{};
    if (!numbers.next(number) || !numbers.is_at_gap()) return false;
    to.push_back(number);
    numbers.skip_comma();
  }
  return true;
}

/// A keyword line in capitals, without blanks.
std::string keyword_of(std::string_view line) {
  std::string word;
  for (const char c : line)
    if (!is_blank(c)) word += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return word;
}

/// Reads the head of a substructure: its rows.
class Head {
 public:
  explicit Head(LineScanner& lines) : lines_(lines) {}

  /// Up to the first *MATRIX, which is left in `line`.
  std::vector<model::RowLabel> read(std::string_view& line) {
    bool is_list = false;
    while (lines_.next(line)) {
      const std::string word = keyword_of(line);
      if (word.starts_with("**")) {
        if (word == "**ELEMENTNODES") {
          is_list = true;
        } else if (is_list && !numbers_of(trimmed_blanks(line).substr(2), nodes_)) {
          is_list = false;
        }
        continue;
      }
      is_list = false;
      if (word.starts_with("*MATRIX,")) return labels();
      if (word.starts_with("*USERELEMENT")) {
        take_user_element(word);
      } else if (!word.empty() && word.front() != '*' && count_ > 0) {
        take_directions(line);
      } else if (!word.empty()) {
        throw InvalidInput(lines_.here(), fmt::format("expected *USER ELEMENT or *MATRIX, got \"{}\"", excerpt(line)));
      }
    }
    throw InvalidInput(lines_.here(), "the file has no *MATRIX: it is cut off, or is no file of a substructure");
  }

 private:
  void take_user_element(const std::string& word) {
    const std::size_t place = word.find("NODES=");
    if (place != std::string::npos) (void)std::from_chars(word.data() + place + 6, word.data() + word.size(), count_);
    if (count_ < 1) throw InvalidInput(lines_.here(), "*USER ELEMENT does not tell NODES=");
    if (word.find("UNSYMM") != std::string::npos)
      throw InvalidInput(lines_.here(), "the matrices of this substructure are not symmetric");
  }
  /// The first line holds the directions of the first node and those after it; others begin with the position of the
  /// node from which they hold.
  void take_directions(std::string_view line) {
    std::vector<int> numbers;
    if (!numbers_of(line, numbers) || numbers.empty())
      throw InvalidInput(lines_.here(), fmt::format("expected degrees of freedom, got \"{}\"", excerpt(line)));
    int from = 1;
    if (!directions_.empty()) {
      from = numbers.front();
      numbers.erase(numbers.begin());
    }
    if (from < 1 || from > count_ || numbers.empty() ||
        std::any_of(numbers.begin(), numbers.end(), [](int d) { return d < 1 || d > 6; }))
      throw InvalidInput(lines_.here(), fmt::format("degrees of freedom are 1 to 6, got \"{}\"", excerpt(line)));
    directions_[from] = numbers;
  }
  std::vector<model::RowLabel> labels() const {
    if (static_cast<int>(nodes_.size()) != count_)
      throw InvalidInput(lines_.here(),
                         fmt::format("the element has {} nodes, and the comment \"** ELEMENT NODES\" before it names "
                                     "{}: without their names its rows have no meaning",
                                     count_, nodes_.size()));
    if (directions_.empty()) throw InvalidInput(lines_.here(), "the line of degrees of freedom is missing");
    std::vector<model::RowLabel> labels;
    const std::vector<int>* directions = nullptr;
    for (int i = 1; i <= count_; ++i) {
      if (const auto found = directions_.find(i); found != directions_.end()) directions = &found->second;
      for (const int direction : *directions) labels.push_back({nodes_[static_cast<std::size_t>(i) - 1], direction});
    }
    return labels;
  }

  LineScanner& lines_;
  std::vector<std::int64_t> nodes_;
  std::map<int, std::vector<int>> directions_;
  int count_ = 0;
};

}  // namespace

void read_abaqus_substructure(const MatrixSource& source, MatrixEntries& entries) {
  LineScanner lines(source.text, source.place);
  std::string_view line;
  const std::vector<model::RowLabel> labels = Head(lines).read(line);
  const std::string wanted = source.kind == "stiffness" ? "STIFFNESS" : source.kind == "mass" ? "MASS" : "DAMPING";
  bool is_wanted = false, is_found = false;
  std::size_t row = 0, column = 0;
  const auto require_all = [&] {
    if (is_wanted && row < labels.size())
      throw InvalidInput(lines.here(),
                         fmt::format("the matrix ends in row {} of {}: the file is cut off", row + 1, labels.size()));
  };
  entries.triangle = Triangle::one;
  do {
    if (trimmed_blanks(line).empty() || trimmed_blanks(line).starts_with("**")) continue;
    if (trimmed_blanks(line).starts_with("*")) {
      require_all();
      const std::string word = keyword_of(line);
      is_wanted = word.starts_with("*MATRIX,") && word.find("TYPE=" + wanted) != std::string::npos;
      if (!is_wanted) continue;
      if (is_found) throw InvalidInput(lines.here(), fmt::format("the {} matrix is given twice", source.kind));
      is_found = true;
      continue;
    }
    if (!is_wanted) continue;
    std::vector<double> values;
    if (!numbers_of(line, values))
      throw InvalidInput(lines.here(), fmt::format("expected numbers and commas, got \"{}\"", excerpt(line)));
    for (const double value : values) {
      if (row >= labels.size())
        throw InvalidInput(lines.here(),
                           fmt::format("more values than the lower triangle of {} rows has", labels.size()));
      entries.add(labels[row], labels[column], value, lines.number());
      if (++column > row) {
        ++row;
        column = 0;
      }
    }
  } while (lines.next(line));
  require_all();
  if (!is_found)
    throw InvalidInput({source.place, 0, 0},
                       fmt::format("the file has no *MATRIX, TYPE={0}; ask for it in the export ({0}=YES)", wanted));
}

}  // namespace rubato::io
