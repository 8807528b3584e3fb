#include "exchange/urdf_elements.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <sstream>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"
#include "common/shell_word.hpp"
#include "common/small_letters.hpp"
#include "common/toml_table.hpp"
#include "exchange/xml_encoding.hpp"
#include "robot/geometry.hpp"

namespace offnominal::desk::exchange {
namespace {

using tinyxml2::XMLElement;

constexpr std::size_t kMostLinks = 2000;

enum class Holds : std::uint8_t { kNumber, kVector, kName };

struct AttributeRule {
  const char* name;
  Holds holds = Holds::kNumber;
  const char* unit = "";
  bool required = false;
  bool may_be_negative = true;
  const char* mend = "";
  double largest = std::numeric_limits<double>::infinity();
};

struct ElementRule {
  const char* name;
  bool required;
  std::span<const AttributeRule> attributes;
};

constexpr AttributeRule kPose[] = {{.name = "xyz", .holds = Holds::kVector, .unit = "m"},
                                   {.name = "rpy",
                                    .holds = Holds::kVector,
                                    .unit = "rad",
                                    .mend = "write the three angles in rad: 90 deg is 1.5708",
                                    .largest = kMostAngleRad}};
constexpr AttributeRule kMass[] = {{.name = "value",
                                    .unit = "kg",
                                    .required = true,
                                    .may_be_negative = false,
                                    .mend = "give the link's mass in kg"}};
constexpr const char* kTensor =
    "give all six elements of the tensor about the centre of mass, in kg m^2";
constexpr AttributeRule kInertia[] = {
    {.name = "ixx", .unit = "kg m^2", .required = true, .mend = kTensor},
    {.name = "ixy", .unit = "kg m^2", .required = true, .mend = kTensor},
    {.name = "ixz", .unit = "kg m^2", .required = true, .mend = kTensor},
    {.name = "iyy", .unit = "kg m^2", .required = true, .mend = kTensor},
    {.name = "iyz", .unit = "kg m^2", .required = true, .mend = kTensor},
    {.name = "izz", .unit = "kg m^2", .required = true, .mend = kTensor}};
constexpr AttributeRule kLink[] = {{.name = "link", .holds = Holds::kName, .required = true}};
constexpr AttributeRule kAxis[] = {
    {.name = "xyz", .holds = Holds::kVector, .required = true, .mend = "give the axis, as 0 0 1"}};
constexpr AttributeRule kLimit[] = {
    {.name = "lower"},
    {.name = "upper"},
    {.name = "effort",
     .required = true,
     .may_be_negative = false,
     .mend = "give the largest torque in N m, or force in N; 0 where it is not known"},
    {.name = "velocity",
     .required = true,
     .may_be_negative = false,
     .mend = "give the largest speed in rad/s or m/s; 0 where it is not known"}};
constexpr AttributeRule kDynamics[] = {
    {.name = "damping", .may_be_negative = false, .mend = "give a damping of 0 or more"},
    {.name = "friction", .may_be_negative = false, .mend = "give a friction of 0 or more"}};
constexpr AttributeRule kMimic[] = {{.name = "joint", .holds = Holds::kName, .required = true},
                                    {.name = "multiplier"},
                                    {.name = "offset"}};

constexpr ElementRule kInertialChildren[] = {
    {"origin", false, kPose}, {"mass", true, kMass}, {"inertia", true, kInertia}};
constexpr ElementRule kJointChildren[] = {{"origin", false, kPose}, {"parent", true, kLink},
                                          {"child", true, kLink},   {"axis", false, kAxis},
                                          {"limit", false, kLimit}, {"dynamics", false, kDynamics},
                                          {"mimic", false, kMimic}};

const std::vector<std::string> kTypes{"revolute", "continuous", "prismatic",
                                      "fixed",    "floating",   "planar"};

std::string tag(const XMLElement& element) { return fmt::format("<{}>", element.Name()); }

bool is_name(std::string_view name) {
  return !name.empty() && std::none_of(name.begin(), name.end(),
                                       [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

// A whole word that is a number, as XML's xs:double has it; nan and inf are none.
std::optional<double> number_in(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0;
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  // What is too small for a double counts as none: 0.
  if (error == std::errc::result_out_of_range && rest == end && std::fabs(value) < 1) return 0;
  if (error != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

class Reader {
 public:
  Reader(std::string_view text, std::string file) : file_(std::move(file)) { parse(text); }

  UrdfElements read() {
    const XMLElement& robot = root();
    if (const char* name = robot.Attribute("name"); name != nullptr && is_name(name)) {
      elements_.robot_name = as_utf8(name);
    }
    refuse_xacro(robot);
    out_.OpenElement("robot");
    out_.PushAttribute("name", "robot");
    for (const XMLElement* child = robot.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const std::string_view name = child->Name();
      if (name == "link") {
        read_link(*child);
      } else if (name == "joint") {
        read_joint(*child);
      } else {
        leave_out(tag(*child), *child);
      }
    }
    out_.CloseElement();
    elements_.xml = out_.CStr();
    return std::move(elements_);
  }

 private:
  [[noreturn]] void refuse(int line, const std::string& place, const std::string& found,
                           const std::string& allowed, const std::string& mend) const {
    const std::string at = line > 0 ? fmt::format("line {}", line) : "";
    throw InputError({.file = file_,
                      .place = at + (at.empty() || place.empty() ? "" : ", ") + place,
                      .found = found,
                      .allowed = allowed,
                      .mend = mend});
  }

  void parse(std::string_view text) {
    constexpr const char* kAllowed = "a URDF, which is XML";
    if (text.starts_with("\x1f\x8b")) {
      refuse(0, "", "data packed with gzip", kAllowed, "unpack it: gzip -d");
    }
    if (const auto zero = text.find('\0'); zero != std::string_view::npos) {
      const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(zero), '\n');
      const bool is_wide = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
      refuse(static_cast<int>(line), "", is_wide ? "UTF-16" : "a byte of zero", kAllowed,
             is_wide ? "save it in UTF-8" : "check the name of the file");
    }
    const XmlText in_utf8 = xml_in_utf8(text, file_);
    elements_.assumed_encoding_line = in_utf8.assumed_line;
    text = in_utf8.text;
    if (document_.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS) return;
    std::string error = document_.ErrorName();
    if (error.starts_with("XML_ERROR_")) error = error.substr(10);
    if (error.starts_with("XML_")) error = error.substr(4);
    std::replace(error.begin(), error.end(), '_', ' ');
    refuse(document_.ErrorLineNum(), "",
           fmt::format("XML that is not well formed ({})", in_small_letters(error)), kAllowed,
           "close every element and quote every attribute there");
  }

  const XMLElement& root() const {
    const XMLElement* element = document_.RootElement();
    const std::string name = element == nullptr ? "" : element->Name();
    if (name == "robot") return *element;
    const std::string found = element == nullptr ? "no element" : "<" + name + "> as the root";
    const std::string format = name == "mujoco" ? " (MJCF)" : name == "sdf" ? " (SDF)" : "";
    refuse(element == nullptr ? 0 : element->GetLineNum(), "", found + format,
           "<robot>, as URDF has it",
           format.empty() ? "name a URDF" : "convert it to URDF with that format's own tools");
  }

  // An element of xacro itself, wherever it stands.
  void refuse_xacro(const XMLElement& element) const {
    if (std::string_view(element.Name()).starts_with("xacro:")) {
      refuse_unexpanded(element, tag(element));
    }
    for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      refuse_xacro(*child);
    }
  }
  [[noreturn]] void refuse_unexpanded(const XMLElement& element, const std::string& found) const {
    const auto without = [](std::string name, std::string_view ending) {
      if (name.ends_with(ending)) name.resize(name.size() - ending.size());
      return name;
    };
    if (file_ == shown_name("-")) {
      refuse(element.GetLineNum(), "", found + ", which is xacro and not expanded", "plain URDF",
             "let xacro write it: xacro FILE | offnominal import-urdf - ...");
    }
    const std::string stem = without(without(file_, ".xacro"), ".urdf");
    const std::string expanded = stem + (file_.ends_with(".xacro") ? ".urdf" : "_expanded.urdf");
    refuse(element.GetLineNum(), "", found + ", which is xacro and not expanded", "plain URDF",
           fmt::format("expand it with `xacro {} > {}`, and import that", shell_word(file_),
                       shell_word(expanded)));
  }

  void leave_out(const std::string& what, const XMLElement& element) {
    LeftOut& entry = elements_.left_out[what];
    if (entry.times++ == 0) entry.line = element.GetLineNum();
  }

  std::string required_name(const XMLElement& element, const char* attribute,
                            const std::string& place) const {
    const char* value = element.Attribute(attribute);
    if (value != nullptr && std::string_view(value).find("${") != std::string_view::npos) {
      refuse_unexpanded(element, fmt::format("\"{}\"", value));
    }
    if (value != nullptr && is_name(value)) return as_utf8(value);
    const std::string at = (place.empty() ? "" : place + ", ") + tag(element);
    refuse(element.GetLineNum(), at,
           value == nullptr
               ? fmt::format("no {}", attribute)
               : fmt::format("a {} that is empty or holds control characters", attribute),
           "a name", fmt::format("give {}=\"...\"", attribute));
  }

  double checked(std::string_view word, const AttributeRule& rule, const XMLElement& element,
                 const std::string& place) const {
    const std::string at = fmt::format("{}, {} {}", place, tag(element), rule.name);
    const auto value = number_in(word);
    std::string allowed = rule.may_be_negative ? "a finite number" : "a finite number >= 0";
    if (*rule.unit != '\0') allowed += fmt::format(", in {}", rule.unit);
    if (!value && word.find("${") != std::string_view::npos) {
      refuse_unexpanded(element, fmt::format("\"{}\"", word));
    }
    if (!value || (!rule.may_be_negative && *value < 0)) {
      refuse(element.GetLineNum(), at, fmt::format("\"{}\"", word), allowed,
             *rule.mend == '\0' ? "write a number" : rule.mend);
    }
    const double largest = std::min(rule.largest, physical(any_number(rule.unit)).largest);
    if (std::fabs(*value) > largest) {
      refuse(element.GetLineNum(), at, shortest(*value),
             fmt::format("at most {}{}{}", shortest(largest), *rule.unit == '\0' ? "" : " ",
                         rule.unit),
             std::isfinite(rule.largest) ? rule.mend : "check the number's unit");
    }
    return *value + 0.0;  // no zero below zero
  }

  // The attribute as urdfdom reads it; none where it is not there.
  std::optional<std::string> value_of(const XMLElement& element, const AttributeRule& rule,
                                      const std::string& place) const {
    if (rule.holds == Holds::kName) return required_name(element, rule.name, place);
    const char* value = element.Attribute(rule.name);
    if (value == nullptr && !rule.required) return std::nullopt;
    const std::string text = value == nullptr ? "" : value;
    const std::string at = fmt::format("{}, {} {}", place, tag(element), rule.name);
    if (value == nullptr) {
      refuse(element.GetLineNum(), at, "nothing", "an attribute", rule.mend);
    }
    const std::vector<std::string> words = words_of(text);
    const std::size_t wanted = rule.holds == Holds::kNumber ? 1 : 3;
    if (text.find("${") != std::string::npos || text.find("$(") != std::string::npos) {
      refuse_unexpanded(element, fmt::format("\"{}\"", text));
    }
    if (words.size() != wanted) {
      refuse(element.GetLineNum(), at, fmt::format("\"{}\"", text),
             wanted == 1 ? "one number" : "three numbers between blanks",
             *rule.mend == '\0' ? "write them" : rule.mend);
    }
    std::string result;
    for (const std::string& word : words) {
      result += (result.empty() ? "" : " ") + shortest(checked(word, rule, element, place));
    }
    return result;
  }

  // Hands an element on to urdfdom. False, and nothing handed on, where nothing in it is known.
  bool copy(const XMLElement& element, const ElementRule& rule, const std::string& place) {
    std::vector<std::pair<const char*, std::string>> attributes;
    for (const AttributeRule& attribute : rule.attributes) {
      if (auto value = value_of(element, attribute, place)) {
        attributes.emplace_back(attribute.name, std::move(*value));
      }
    }
    for (const auto* found = element.FirstAttribute(); found != nullptr; found = found->Next()) {
      const bool known = std::any_of(rule.attributes.begin(), rule.attributes.end(),
                                     [&](const AttributeRule& known_one) {
                                       return known_one.name == std::string(found->Name());
                                     });
      if (!known) leave_out(fmt::format("`{}` of {}", found->Name(), tag(element)), element);
    }
    if (attributes.empty()) return false;
    out_.OpenElement(rule.name);
    for (const auto& [name, value] : attributes) out_.PushAttribute(name, value.c_str());
    out_.CloseElement();
    return true;
  }

  // Every child that a rule names, each at most once; the others are left out. The names of those
  // that were handed on.
  std::vector<std::string> copy_children(const XMLElement& parent,
                                         std::span<const ElementRule> rules,
                                         const std::string& place) {
    std::vector<std::string> seen;
    std::vector<std::string> copied;
    for (const XMLElement* child = parent.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const std::string name = child->Name();
      const auto rule = std::find_if(rules.begin(), rules.end(),
                                     [&](const ElementRule& one) { return name == one.name; });
      if (rule == rules.end()) {
        leave_out(tag(*child), *child);
        continue;
      }
      refuse_second(*child, seen, place);
      if (copy(*child, *rule, place)) copied.push_back(name);
    }
    for (const ElementRule& rule : rules) {
      if (!rule.required || std::find(seen.begin(), seen.end(), rule.name) != seen.end()) continue;
      refuse(parent.GetLineNum(), place, fmt::format("no <{}> in {}", rule.name, tag(parent)),
             fmt::format("one <{}>", rule.name), "add it");
    }
    return copied;
  }

  void refuse_second(const XMLElement& element, std::vector<std::string>& seen,
                     const std::string& place) const {
    if (std::find(seen.begin(), seen.end(), element.Name()) != seen.end()) {
      refuse(element.GetLineNum(), place, "a second " + tag(element), "one", "remove one of them");
    }
    seen.emplace_back(element.Name());
  }

  void read_link(const XMLElement& link) {
    const std::string name = required_name(link, "name", "");
    const std::string place = fmt::format("link `{}`", name);
    if (elements_.link_lines.size() == kMostLinks) {
      refuse(link.GetLineNum(), place, fmt::format("more than {} links", kMostLinks),
             "a robot of less", "check the name of the file");
    }
    if (const auto [at, added] = elements_.link_lines.emplace(name, link.GetLineNum()); !added) {
      refuse(link.GetLineNum(), place, fmt::format("the name of the link in line {}", at->second),
             "names that differ", "rename or remove one of them");
    }
    out_.OpenElement("link");
    out_.PushAttribute("name", name.c_str());
    std::vector<std::string> seen;
    for (const XMLElement* child = link.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      if (std::string_view(child->Name()) != "inertial") {
        leave_out(tag(*child), *child);
        continue;
      }
      refuse_second(*child, seen, place);
      out_.OpenElement("inertial");
      copy_children(*child, kInertialChildren, place);
      out_.CloseElement();
    }
    out_.CloseElement();
  }

  void read_joint(const XMLElement& joint) {
    JointElement element;
    element.name = required_name(joint, "name", "");
    element.line = joint.GetLineNum();
    const std::string place = fmt::format("joint `{}`", element.name);
    for (const JointElement& other : elements_.joints) {
      if (other.name != element.name) continue;
      refuse(element.line, place, fmt::format("the name of the joint in line {}", other.line),
             "names that differ", "rename or remove one of them");
    }
    element.type = required_name(joint, "type", place);
    if (std::find(kTypes.begin(), kTypes.end(), element.type) == kTypes.end()) {
      const std::string meant = nearest(element.type, kTypes);
      refuse(element.line, place, fmt::format("the type \"{}\"", element.type), choice_of(kTypes),
             meant.empty() ? "give one of them" : fmt::format("write type=\"{}\"", meant));
    }
    out_.OpenElement("joint");
    out_.PushAttribute("name", element.name.c_str());
    out_.PushAttribute("type", element.type.c_str());
    const auto copied = copy_children(joint, kJointChildren, place);
    out_.CloseElement();
    const auto has = [&](const char* part) {
      return std::find(copied.begin(), copied.end(), part) != copied.end();
    };
    element.has_axis = has("axis");
    if (!has("limit") && (element.type == "revolute" || element.type == "prismatic")) {
      refuse(element.line, place, "no <limit>",
             fmt::format("one, as URDF asks of a {} joint", element.type),
             element.type == "revolute"
                 ? "add it, or write type=\"continuous\" where it turns without end"
                 : "add it");
    }
    element.parent = required_name(*joint.FirstChildElement("parent"), "link", place);
    element.child = required_name(*joint.FirstChildElement("child"), "link", place);
    elements_.joints.push_back(std::move(element));
  }

  std::string file_;
  tinyxml2::XMLDocument document_;
  tinyxml2::XMLPrinter out_{nullptr, true};
  UrdfElements elements_;
};

}  // namespace

UrdfElements read_urdf_elements(std::string_view text, const std::string& file) {
  return Reader(text, file).read();
}

}  // namespace offnominal::desk::exchange
