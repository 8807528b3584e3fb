#include "expected_case.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <set>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/nearest.hpp"
#include "common/toml_table.hpp"
#include "explain/explain.hpp"

namespace offnominal::bench {
namespace {

using desk::InputError;
using desk::list_of;
using desk::TomlTable;

std::string words_of(const Claim& claim) {
  const std::string any = desk::choice_of(claim.words);
  switch (claim.kind) {
    case Claim::Kind::kNames:
      return "names " + any + (claim.order ? fmt::format(" of order {:g}", *claim.order) : "");
    case Claim::Kind::kNever:
      return "does not find " + any;
    case Claim::Kind::kNothingFound:
      return "finds nothing";
    case Claim::Kind::kNumber:
      return fmt::format("{} within {:g} to {:g}", any, claim.from, claim.to);
    case Claim::Kind::kLeft:
      return fmt::format("at most {:g} % left", 100 * claim.to);
    case Claim::Kind::kVerdict:
      return "says " + any;
    case Claim::Kind::kOver:
      return "a torque over " + any;
    case Claim::Kind::kFault:
      return "names a fault: " + any;
  }
  return {};
}

class Reader {
 public:
  Reader(std::string file, const toml::table& document)
      : file_(std::move(file)), document_(document) {}

  std::vector<ExpectedCase> read() const {
    const TomlTable root(file_, "", document_, {"case"});
    std::vector<ExpectedCase> cases;
    std::set<std::string> names;
    for (const TomlTable& table : root.tables("case", kCaseKeys)) {
      ExpectedCase one;
      one.name = table.text("name");
      one.robot = table.text("robot");
      one.source = table.text("source");
      const toml::table& raw =
          *document_.get_as<toml::array>("case")->get_as<toml::table>(cases.size());
      one.logs = texts(raw, one.name, "logs");
      if (one.logs.empty()) fail(one.name, "no logs", "one recording or more");
      one.holdout = texts(raw, one.name, "holdout");
      const toml::array* claims = raw.get_as<toml::array>("claim");
      if (claims == nullptr || claims->empty()) fail(one.name, "no claim", "one claim or more");
      for (const toml::node& node : *claims) {
        const toml::table* claim = node.as_table();
        if (claim == nullptr)
          fail(one.name, "a claim that is no table", "{joint = 1, names = [..]}");
        one.claims.push_back(claim_of(*claim, one.name));
      }
      if (!names.insert(one.name).second) fail(one.name, "the name twice", "names that differ");
      cases.push_back(std::move(one));
    }
    if (cases.empty()) fail("case", "nothing", "one [[case]] or more");
    return cases;
  }

 private:
  inline static const std::vector<std::string> kCaseKeys{"name",    "robot",  "logs",
                                                         "holdout", "source", "claim"};

  [[noreturn]] void fail(const std::string& place, const std::string& found,
                         const std::string& allowed) const {
    throw InputError({file_, place, found, allowed, ""});
  }

  std::vector<std::string> texts(const toml::table& table, const std::string& place,
                                 const std::string& key) const {
    std::vector<std::string> all;
    const toml::node* node = table.get(key);
    if (node == nullptr) return all;
    const toml::array* array = node->as_array();
    if (array == nullptr) fail(place, key + " that is no list", "a list of strings");
    for (const toml::node& one : *array) {
      if (!one.is_string()) fail(place, key + " with something else in it", "a list of strings");
      all.push_back(one.as_string()->get());
    }
    return all;
  }

  double number(const toml::table& table, const std::string& place, const std::string& key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr || !node->is_number()) fail(place, "no number " + key, "a number");
    return *node->value<double>();
  }

  void check_effects(const std::vector<std::string>& names, const std::string& place) const {
    for (const std::string& name : names) {
      const auto is_it = [&](const EffectInfo& info) { return name == info.name; };
      if (std::any_of(kAllEffectInfos.begin(), kAllEffectInfos.end(), is_it)) continue;
      fail(place, "the effect " + name, "an effect of docs/robot-file.md");
    }
  }

  void check_verdicts(const std::vector<std::string>& words, const std::string& place) const {
    const auto known = desk::verdict_names();
    for (const std::string& word : words) {
      if (std::find(known.begin(), known.end(), word) != known.end()) continue;
      fail(place, "the verdict " + word, list_of(known));
    }
  }

  // The words of a key, checked; none where the claim does not have it.
  std::vector<std::string> effects_of(const toml::table& table, const std::string& place,
                                      const std::string& key) const {
    std::vector<std::string> names = texts(table, place, key);
    check_effects(names, place);
    return names;
  }

  static std::vector<std::string> word_of(const toml::table& table, const char* key) {
    return {table[key].value_or(std::string())};
  }

  Claim claim_of(const toml::table& table, const std::string& place) const {
    using Kind = Claim::Kind;
    static const std::vector<std::string> kKeys{
        "joint", "names", "never",        "nothing_found", "number", "from",
        "to",    "order", "left_at_most", "verdicts",      "over",   "fault"};
    for (const auto& [key, node] : table) {
      const std::string name(key.str());
      if (std::find(kKeys.begin(), kKeys.end(), name) != kKeys.end()) continue;
      fail(place, "the key " + name, list_of(kKeys));
    }
    Claim claim;
    if (table.contains("joint")) claim.joint = static_cast<int>(number(table, place, "joint"));
    if (table.contains("order")) claim.order = number(table, place, "order");
    if (table.contains("names")) {
      claim.words = effects_of(table, place, "names");
    } else if (table.contains("never")) {
      claim.kind = Kind::kNever;
      claim.words = effects_of(table, place, "never");
    } else if (table.contains("nothing_found")) {
      claim.kind = Kind::kNothingFound;
    } else if (table.contains("number")) {
      claim.kind = Kind::kNumber;
      claim.words = word_of(table, "number");
      const auto dot = claim.words[0].find('.');
      if (dot == std::string::npos) fail(place, claim.words[0], "EFFECT.PARAMETER");
      check_effects({claim.words[0].substr(0, dot)}, place);
      claim.from = number(table, place, "from");
      claim.to = number(table, place, "to");
    } else if (table.contains("left_at_most")) {
      claim.kind = Kind::kLeft;
      claim.to = number(table, place, "left_at_most");
    } else if (table.contains("verdicts")) {
      claim.kind = Kind::kVerdict;
      claim.words = texts(table, place, "verdicts");
      check_verdicts(claim.words, place);
    } else if (table.contains("over")) {
      claim.kind = Kind::kOver;
      claim.words = word_of(table, "over");
    } else if (table.contains("fault")) {
      claim.kind = Kind::kFault;
      claim.words = word_of(table, "fault");
    } else {
      fail(place, "a claim that says nothing", list_of(kKeys));
    }
    claim.text = (claim.joint ? fmt::format("joint {}: ", *claim.joint) : "") + words_of(claim);
    return claim;
  }

  std::string file_;
  const toml::table& document_;
};

}  // namespace

std::vector<ExpectedCase> read_expectations(const std::filesystem::path& file) {
  const toml::table document = desk::parse_toml(desk::read_text_file(file), file.string());
  return Reader(file.string(), document).read();
}

}  // namespace offnominal::bench
