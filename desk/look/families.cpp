#include "look/families.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "common/small_letters.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

bool is_number_word(const std::string& word) { return word[0] >= '0' && word[0] <= '9'; }

// Words that tell how a value came about, and no joint from another.
bool is_qualifier(const std::string& word) {
  static constexpr std::array<std::string_view, 27> kQualifiers{
      "act",  "actual", "meas",   "measured", "filt", "filtered", "raw",    "mot",  "motor",
      "load", "link",   "ist",    "se",       "abs",  "joint",    "joints", "axis", "current",
      "est",  "rec",    "states", "msg",      "data", "field",    "con",    "fric", "side"};
  return is_number_word(word) ||
         std::find(kQualifiers.begin(), kQualifiers.end(), word) != kQualifiers.end();
}

bool is_unit_word(const std::string& word) {
  static constexpr std::array<std::string_view, 12> kUnitWords{
      "deg", "rad", "per", "s", "rpm", "nm", "mnm", "ma", "a", "mm", "m", "ms"};
  return std::find(kUnitWords.begin(), kUnitWords.end(), word) != kUnitWords.end();
}

Role role_or_what_it_would_be(const NameGuess& guess) {
  return guess.role == Role::kNone ? guess.not_measured : guess.role;
}

Family& family_in(std::vector<Family>& families, const std::string& name, const NameGuess& guess) {
  const Role role = role_or_what_it_would_be(guess);
  const auto at = std::find_if(families.begin(), families.end(), [&](const Family& family) {
    return family.name == name && family.role == role;
  });
  if (at != families.end()) return *at;
  families.push_back({name, role, guess.of_motor, guess.role != Role::kNone, {}});
  return families.back();
}

bool is_of_quantity(const NameGuess& guess) {
  const Role role = role_or_what_it_would_be(guess);
  return role != Role::kNone && role != Role::kTime;
}

// Without the words that people add to a joint's name, and numbers without leading zeros.
std::vector<std::string> bare_words(const std::string& name) {
  std::vector<std::string> words;
  for (const NameWord& word : words_in(name)) {
    if (word.text == "joint" || word.text == "link" || word.text == "axis") continue;
    words.push_back(word.text);
  }
  return words;
}

// Desired, reference, commanded; "m" and "s" are of motors and sensors.
bool is_letter_of_asked(const std::string& word) {
  return word == "d" || word == "r" || word == "c";
}

// Whether the words of `name` are those of `plain` and such a letter, and no more.
bool is_asked_beside(const std::string& name, const std::string& plain) {
  std::vector<std::string> words = bare_words(name);
  const std::vector<std::string> wanted = bare_words(plain);
  for (std::size_t i = 0; i < words.size() && words.size() == wanted.size() + 1; ++i) {
    if (!is_letter_of_asked(words[i])) continue;
    std::vector<std::string> left = words;
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
    if (left == wanted) return true;
  }
  return false;
}

bool contains_words(const std::vector<std::string>& words, const std::vector<std::string>& part) {
  return !part.empty() &&
         std::search(words.begin(), words.end(), part.begin(), part.end()) != words.end();
}

bool has_joint_of(const Family& family, const FamilyMember& member) {
  return std::any_of(family.members.begin(), family.members.end(), [&](const FamilyMember& one) {
    return one.number == member.number && one.joint == member.joint;
  });
}

// Whether families are one whose joints have units of their own: no joint is in two of them.
bool are_parts(const std::vector<const Family*>& families) {
  for (std::size_t i = 0; i < families.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const auto& members = families[i]->members;
      if (std::any_of(members.begin(), members.end(), [&](const FamilyMember& member) {
            return has_joint_of(*families[k], member);
          })) {
        return false;
      }
    }
  }
  return families.size() > 1;
}

// Makes one family of those whose names differ in nothing but the unit, "tau1 [mN m]" and
// "tau2 [N mm]". Where a joint stands in two of them, as in rad and in deg, they stay apart.
void join_over_units(std::vector<Family>& families) {
  std::vector<Family> joined;
  std::vector<bool> is_taken(families.size());
  for (std::size_t i = 0; i < families.size(); ++i) {
    if (is_taken[i]) continue;
    const std::string name = without_unit(families[i].name);
    std::vector<const Family*> alike;
    for (std::size_t k = i; k < families.size(); ++k) {
      if (families[k].role != families[i].role || without_unit(families[k].name) != name) continue;
      alike.push_back(&families[k]);
    }
    joined.push_back(families[i]);
    if (!are_parts(alike)) continue;
    joined.back().name = name;
    for (std::size_t k = 1; k < alike.size(); ++k) {
      is_taken[static_cast<std::size_t>(alike[k] - families.data())] = true;
      joined.back().members.insert(joined.back().members.end(), alike[k]->members.begin(),
                                   alike[k]->members.end());
    }
  }
  families = std::move(joined);
}

}  // namespace

std::vector<Family> numbered_families(const std::vector<NamedColumn>& columns) {
  std::vector<Family> families;
  for (const NamedColumn& column : columns) {
    const NameGuess guess = guess_of(column.name, column.said_unit);
    if (!is_of_quantity(guess)) continue;
    family_in(families, guess.family, guess)
        .members.push_back({guess.number, {}, column.name, column.is_constant});
  }
  join_over_units(families);
  for (Family& family : families) {
    std::sort(family.members.begin(), family.members.end(),
              [](const FamilyMember& a, const FamilyMember& b) {
                return std::pair(a.number, a.column) < std::pair(b.number, b.column);
              });
  }
  return families;
}

std::vector<Family> families_by_name(const std::vector<NamedColumn>& columns) {
  std::vector<Family> families;
  for (const NamedColumn& column : columns) {
    const NameGuess guess = guess_of(column.name, column.said_unit);
    if (!is_of_quantity(guess)) continue;
    const std::vector<NameWord> words = words_in(column.name);
    for (std::size_t first = 0; first < words.size(); ++first) {
      std::size_t end = first;
      bool names_joint = false;
      while (end < words.size() && !says_quantity(words[end].text) &&
             !(end > first && is_unit_word(words[end].text))) {
        names_joint = names_joint || !is_qualifier(words[end].text);
        ++end;
      }
      if (end == first) continue;
      if (names_joint && !is_unit_word(words[first].text)) {
        const std::size_t begin_at = words[first].begin;
        const std::size_t end_at = words[end - 1].end;
        const std::string pattern =
            column.name.substr(0, begin_at) + "*" + column.name.substr(end_at);
        std::string joint = in_small_letters(column.name.substr(begin_at, end_at - begin_at));
        family_in(families, pattern, guess)
            .members.push_back({guess.number, std::move(joint), column.name, column.is_constant});
      }
      first = end;
    }
  }
  join_over_units(families);
  return families;
}

Family in_order_of(const Family& family, const std::vector<std::string>& joints) {
  Family ordered{family.name, family.role, family.of_motor, family.is_measured, {}};
  for (const std::string& joint : joints) {
    const std::vector<std::string> wanted = bare_words(joint);
    // The same words before those that are among others: "wrist" and "lower wrist".
    const FamilyMember* found = nullptr;
    for (const bool exactly : {true, false}) {
      int matches = 0;
      for (const FamilyMember& member : family.members) {
        const std::vector<std::string> words = bare_words(member.joint);
        if (exactly ? words != wanted : !contains_words(words, wanted)) continue;
        found = &member;
        ++matches;
      }
      if (matches == 1) break;
      found = nullptr;
    }
    const bool twice = found != nullptr &&
                       std::any_of(ordered.members.begin(), ordered.members.end(),
                                   [&](const auto& one) { return one.column == found->column; });
    if (found == nullptr || twice) {
      ordered.members.clear();
      return ordered;
    }
    ordered.members.push_back(*found);
  }
  return ordered;
}

std::vector<std::string> other_words(const std::string& name) {
  std::vector<std::string> words;
  for (const NameWord& word : words_in(name)) {
    if (says_quantity(word.text) || is_number_word(word.text) || is_unit_word(word.text)) continue;
    words.push_back(word.text);
  }
  return words;
}

bool may_be_asked_for(const Family& family) {
  if (family.members.empty() || family.members[0].number < 0) return false;
  const std::vector<std::string> words = bare_words(family.name);
  return std::any_of(words.begin(), words.end(), is_letter_of_asked);
}

std::vector<Family> take_not_measured(std::vector<Family>& families) {
  std::vector<Family> measured;
  std::vector<Family> others;
  for (const Family& family : families) {
    const bool is_asked = std::any_of(families.begin(), families.end(), [&](const Family& plain) {
      return plain.role == family.role && plain.members.size() == family.members.size() &&
             is_asked_beside(family.name, plain.name);
    });
    (family.is_measured && !is_asked ? measured : others).push_back(family);
  }
  families = std::move(measured);
  return others;
}

}  // namespace offnominal::desk
