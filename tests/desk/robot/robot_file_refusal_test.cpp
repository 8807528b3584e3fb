#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"

// One mistake each: the message has to name the file, the line, the key, what stands there, what
// may stand there and how to mend it.

namespace offnominal::desk {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Mistake {
  const char* name;
  const char* from;  // what the good file says
  const char* to;    // what the wrong one says
  const char* at;    // text on the line that the message has to name
  const char* path;
  const char* found;
  const char* allowed;
  const char* mend;
};

void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.name; }

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(parse_robot(text, "dir/r.toml"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::string line_of(const std::string& text, const std::string& part) {
  const auto at = text.find(part);
  if (at == std::string::npos) return "nowhere";
  const auto breaks =
      std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  return "line " + std::to_string(breaks + 1);
}

class Refusal : public testing::TestWithParam<Mistake> {};

TEST_P(Refusal, NamesFileLineKeyFoundAllowedAndRemedy) {
  const Mistake& mistake = GetParam();
  const std::string text = test::changed(test::kSampleRobot, mistake.from, mistake.to);
  const std::string message = refusal(text);
  const std::string path = mistake.path;
  const std::string place = line_of(text, mistake.at) + (path.empty() ? "" : ", " + path);
  EXPECT_THAT(message, StartsWith("dir/r.toml: " + place + ": found " + mistake.found));
  EXPECT_THAT(message, HasSubstr(std::string("; allowed: ") + mistake.allowed));
  EXPECT_THAT(message, HasSubstr(std::string("; to mend: ") + mistake.mend));
}

const std::vector<Mistake> kMistakes{
    // Keys.
    {"UnknownKey", "mass_kg = 2.5", "mas_kg = 2.5", "mas_kg", "joint[1].link.mas_kg",
     "an unknown key", "mass_kg, centre_of_mass_m, inertia_kg_m2", "write `mass_kg`"},
    {"UnknownKeyWithoutLikeness", "seed = 7", "colour = 7", "colour", "estimator.colour",
     "an unknown key", "period_s, alpha_per_s", "remove it"},
    {"UnknownTable", "[estimator]", "[estimators]", "[estimators]", "estimators", "an unknown key",
     "format, name", "write `estimator`"},
    {"MissingKey", "mass_kg = 2.5\n", "", "[joint.link]", "joint[1].link.mass_kg",
     "nothing: the key is missing", "a finite number > 0, in kg", "add `mass_kg`"},
    {"MissingTable", "[joint.link]\nmass_kg = 1.0\ncentre_of_mass_m = [0.0, 0.0, 0.0]\n", "",
     "[[joint]]\nname = \"slide\"", "joint[2].link", "nothing: the key is missing", "a table",
     "add `link`"},
    {"MissingFormat", "format = 1\n", "", "name = \"sample\"", "format",
     "nothing: the key is missing", "a whole number", "add `format`"},
    {"FormatOfTheFuture", "format = 1", "format = 2", "format", "format",
     "a format that this version does not know", "1", "use the version"},
    {"EmptyName", "\"turn\"", "\"\"", "name = \"\"", "joint[1].name", "the string \"\"",
     "a string that is not empty", "write it"},
    {"SameNameTwice", "\"slide\"", "\"turn\"", "name = \"turn\"\ntype = \"prismatic\"",
     "joint[2].name", "the name \"turn\" a second time", "names that differ", "give this joint"},
    // Types.
    {"StringForNumber", "mass_kg = 2.5", "mass_kg = \"2.5\"", "\"2.5\"", "joint[1].link.mass_kg",
     "the string \"2.5\"", "a finite number > 0, in kg", "write the number without quotes"},
    {"NumberForString", "\"slide\"", "3", "name = 3", "joint[2].name", "3",
     "a string that is not empty", "write it in quotes"},
    {"NumberForList", "[0.1, 0.0, -0.05]", "0.1", "centre_of_mass_m = 0.1",
     "joint[1].link.centre_of_mass_m", "0.1", "a list of 3 numbers", "write [x, y, z]"},
    {"TextInList", "[0.1, 0.0, -0.05]", "[0.1, \"a\", 0]", "\"a\"",
     "joint[1].link.centre_of_mass_m[2]", "the string \"a\"", "a finite number, in m",
     "write the number without quotes"},
    {"NumberForBoolean", "fitted = true", "fitted = 1", "fitted", "effect[1].fitted", "1",
     "true or false", "write it without quotes"},
    {"FloatForWhole", "hidden_units = 12", "hidden_units = 12.5", "hidden_units",
     "estimator.hidden_units", "12.5", "a whole number from 1 to 128", "write such a number"},
    {"NumberForTable", "{xx = 0.02, yy = 0.03, zz = 0.025, xy = 0.001, xz = 0.0, yz = -0.002}",
     "0.02", "inertia_kg_m2", "joint[1].link.inertia_kg_m2", "0.02", "a table", "write it as ["},
    {"TableForListOfTables", "[[effect]]\nkind = \"viscous_friction\"",
     "[[effects]]\nkind = \"viscous_friction\"", "[[effects]]", "effects", "an unknown key",
     "format", "write `effect`"},
    {"DateForNumber", "velocity = 4.0", "velocity = 2020-01-01", "velocity",
     "joint[1].limits.velocity", "a date or time", "a finite number > 0, in rad/s", "write one"},
    {"UnknownWord", "\"prismatic\"", "\"prismatc\"", "prismatc", "joint[2].type",
     "the string \"prismatc\"", "revolute, prismatic", "write \"prismatic\""},
    // Ranges.
    {"NegativeMass", "mass_kg = 2.5", "mass_kg = -2.5", "mass_kg", "joint[1].link.mass_kg", "-2.5",
     "a finite number > 0, in kg", "give the link's mass in kg"},
    {"ZeroMass", "mass_kg = 2.5", "mass_kg = 0", "mass_kg", "joint[1].link.mass_kg", "0",
     "a finite number > 0, in kg", "give the link's mass in kg"},
    {"NoBits", "bits = 17", "bits = 0", "bits", "joint[1].encoder.bits", "0",
     "a whole number from 1 to 32", "write such a number"},
    {"TooManyBits", "bits = 17", "bits = 99", "bits", "joint[1].encoder.bits", "99",
     "a whole number from 1 to 32", "write such a number"},
    {"BitsOnSlide", "counts_per_unit = 2e7", "bits = 12", "bits = 12", "joint[2].encoder.bits",
     "bits of a turn on a prismatic joint", "counts_per_unit", "give the counts per metre"},
    {"BitsBesideCounts", "bits = 17", "bits = 17\ncounts_per_unit = 5.0", "[joint.encoder]",
     "joint[1].encoder", "both keys", "either bits or counts_per_unit", "give one of them"},
    {"RotationInDegrees", "rpy_rad = [0.1", "rpy_rad = [90.0", "rpy_rad", "joint[1].rpy_rad[1]",
     "90", "a number from -6.28", "give radians"},
    {"NegativeVelocityLimit", "velocity = 4.0", "velocity = -4.0", "velocity",
     "joint[1].limits.velocity", "-4", "a finite number > 0, in rad/s", "write a number"},
    {"LimitsExchanged", "[-3.0, 3.0]", "[3.0, -3.0]", "position", "joint[1].limits.position",
     "from 3 to -3", "[lower, upper]", "exchange them"},
    {"NegativeGain", "kd_per_s = 20.0", "kd_per_s = -20.0", "kd_per_s", "joint[1].control.kd_per_s",
     "-20", "a finite number >= 0, in 1/s", "write a number"},
    {"AlphaNotPositive", "alpha_per_s = 20.0", "alpha_per_s = 0.0", "alpha_per_s",
     "estimator.alpha_per_s", "0", "a finite number > 0, in 1/s", "give the pole"},
    {"NegativeAlpha", "alpha_per_s = 20.0", "alpha_per_s = -1", "alpha_per_s",
     "estimator.alpha_per_s", "-1", "a finite number > 0, in 1/s", "give the pole"},
    {"UnstablePeriod", "alpha_per_s = 20.0", "alpha_per_s = 600.0", "alpha_per_s",
     "estimator.alpha_per_s", "alpha_per_s * period_s = 1.2", "at most 1",
     "lower alpha_per_s to 500"},
    {"UnstablePeriodAlone", "period_s = 0.002\nalpha_per_s = 20.0", "period_s = 0.2", "period_s",
     "estimator.period_s", "alpha_per_s * period_s = 2", "at most 1", "lower alpha_per_s to 5"},
    {"RadiusNotPositive", "weight_radius = 3.0", "weight_radius = 0.0", "weight_radius",
     "estimator.weight_radius", "0", "a finite number > 0", "give the radius M"},
    {"NegativeRate", "learning_rate = 0.5", "learning_rate = -0.5", "learning_rate",
     "estimator.learning_rate", "-0.5", "a finite number >= 0", "give the rate"},
    {"NoPeriod", "period_s = 0.002", "period_s = 0", "period_s", "estimator.period_s", "0",
     "a finite number > 0, in s", "give the length"},
    {"NegativeSeed", "seed = 7", "seed = -7", "seed", "estimator.seed", "-7",
     "a whole number from 0 to 4294967295", "write such a number"},
    {"TooManyHiddenUnits", "hidden_units = 12", "hidden_units = 1000", "hidden_units",
     "estimator.hidden_units", "1000", "a whole number from 1 to 128", "write such a number"},
    {"NoInitialWeights", "initial_weight_range = 0.2", "initial_weight_range = 0.0",
     "initial_weight_range", "estimator.initial_weight_range", "0", "a finite number > 0",
     "write a number"},
    {"InitialWeightsOutsideTheRadius", "initial_weight_range = 0.2", "initial_weight_range = 0.6",
     "[estimator]", "estimator", "initial weights of norm 3.", "initial weights inside the radius",
     "lower estimator.initial_weight_range"},
    {"UnknownDeadZone", "\"discontinuous\"", "\"none\"", "dead_zone", "estimator.dead_zone",
     "the string \"none\"", "continuous, discontinuous", "write one of these"},
    {"UnknownTorqueSignal", "\"held\"", "\"zoh\"", "torque_signal", "estimator.torque_signal",
     "the string \"zoh\"", "sampled, held", "write one of these"},
    {"NoArmingWindow", "position_window = [0.1, 0.02]", "position_window = [0.1, 0.0]",
     "position_window", "arming.position_window[2]", "0", "a finite number > 0, in rad or m",
     "write a number"},
    {"ArmingOfOneJoint", "speed = [0.2, 0.03]", "speed = [0.2]", "speed", "arming.speed",
     "a list of 1", "a list of 2 numbers", "write"},
    {"NotANumber", "velocity = 4.0", "velocity = nan", "velocity", "joint[1].limits.velocity",
     "nan", "a finite number > 0, in rad/s", "write a number"},
    {"Infinity", "mass_kg = 2.5", "mass_kg = inf", "mass_kg", "joint[1].link.mass_kg", "inf",
     "a finite number > 0, in kg", "give the link's mass"},
    {"NotANumberInList", "[0.0, 0.0, -9.81]", "[0.0, nan, -9.81]", "gravity_m_s2",
     "gravity_m_s2[2]", "nan", "a finite number, in m/s^2", "write a number"},
    // Numbers of another unit, by their size.
    {"GravityInMillimetres", "[0.0, 0.0, -9.81]", "[0.0, 0.0, -9810.0]", "gravity_m_s2",
     "gravity_m_s2[3]", "-9810", "at most 100 m/s^2: no robot has more",
     "write it in m/s^2: a number in mm/s^2 divided by 1000"},
    {"CentreOfMassInMillimetres", "[0.1, 0.0, -0.05]", "[500.0, 0.0, -0.05]", "500.0",
     "joint[1].link.centre_of_mass_m[1]", "500", "at most 100 m: no robot has more",
     "write it in m: a number in mm divided by 1000"},
    {"OriginInMillimetres", "name = \"slide\"", "name = \"slide\"\norigin_m = [0, 0, 500]",
     "origin_m = [0, 0, 500]", "joint[2].origin_m[3]", "500", "at most 100 m: no robot has more",
     "write it in m: a number in mm divided by 1000"},
    // Geometry.
    {"AxisTooShort", "[0.0, 0.0, 1.0]", "[0.0, 0.0, 0.5]", "axis", "joint[1].axis",
     "a vector of length 0.5", "a vector of length 1", "divide the vector by its length"},
    {"AxisOfFour", "[0.0, 0.0, 1.0]", "[0.0, 0.0, 0.0, 1.0]", "axis", "joint[1].axis",
     "a list of 4", "a list of 3 numbers", "write [x, y, z]"},
    {"GravityOfTwo", "[0.0, 0.0, -9.81]", "[0.0, -9.81]", "gravity_m_s2", "gravity_m_s2",
     "a list of 2", "a list of 3 numbers", "write [x, y, z]"},
    {"NoRotation", "[[0.0, -1.0, 0.0]", "[[0.0, -1.1, 0.0]", "rotation", "joint[2].rotation",
     "a matrix that is no rotation", "rows of length 1 at right angles", "check the matrix"},
    {"Mirror", "[[0.0, -1.0, 0.0]", "[[0.0, 1.0, 0.0]", "rotation", "joint[2].rotation",
     "a matrix that is no rotation", "rows of length 1", "check the matrix"},
    {"RotationOfTwoRows", "[[0.0, -1.0, 0.0], ", "[", "rotation", "joint[2].rotation",
     "a list of 2", "a list of 3 rows of 3 numbers", "write [[...], [...]]"},
    {"ShortRowOfRotation", "[[0.0, -1.0, 0.0]", "[[0.0, -1.0]", "rotation", "joint[2].rotation[1]",
     "a list of 2", "a list of 3 numbers", "write [x, y, z]"},
    {"RotationTwice", "rotation = ", "rpy_rad = [0.0, 0.0, 0.0]\nrotation = ", "rotation",
     "joint[2].rotation", "rotation beside rpy_rad", "one of them", "remove one"},
    {"InertiaNotPositiveDefinite", "xx = 0.02", "xx = -0.02", "inertia_kg_m2",
     "joint[1].link.inertia_kg_m2",
     "a tensor that is not positive definite (principal moments -0.0", "a positive definite tensor",
     "check the signs"},
    {"ProductOfInertiaTooLarge", "xy = 0.001", "xy = 0.03", "inertia_kg_m2",
     "joint[1].link.inertia_kg_m2", "a tensor that is not positive definite",
     "a positive definite tensor", "check the signs"},
    {"InertiaBreaksTriangleInequality", "zz = 0.025", "zz = 0.25", "inertia_kg_m2",
     "joint[1].link.inertia_kg_m2", "a tensor that breaks the triangle inequality",
     "a positive definite tensor", "check the signs"},
    {"InertiaWithoutADiagonal", "xx = 0.02, ", "", "inertia_kg_m2",
     "joint[1].link.inertia_kg_m2.xx", "nothing: the key is missing", "a finite number, in kg m^2",
     "add `xx`"},
    // Effects.
    {"UnknownEffect", "\"viscous_friction\"", "\"viscus_friction\"", "viscus", "effect[2].kind",
     "the string \"viscus_friction\"", "viscous_friction, coulomb_friction, friction_asymmetry",
     "write \"viscous_friction\""},
    {"EffectOnJointZero", "joint = 1", "joint = 0", "joint = 0", "effect[1].joint", "0",
     "a whole number from 1 to 2", "write such a number"},
    {"EffectBehindTheLastJoint", "joint = 1", "joint = 3", "joint = 3", "effect[1].joint", "3",
     "a whole number from 1 to 2", "write such a number"},
    {"EffectWithoutParameter", "coefficient = 12\n", "", "[[effect]]\nkind = \"viscous",
     "effect[2].coefficient", "nothing: the key is missing", "a finite number >= 0, in N s/m",
     "add `coefficient`"},
    {"ParameterOfAnotherEffect", "coefficient = 12", "coefficient = 12\nlevel = 3", "level = 3",
     "effect[2].level", "a parameter that viscous_friction does not have", "coefficient",
     "remove it"},
    {"ParameterOutOfRange", "stribeck_velocity = 0.2", "stribeck_velocity = 0.0",
     "stribeck_velocity", "effect[1].stribeck_velocity", "0", "a finite number >= 1e-09, in rad/s",
     "give the velocity at which"},
    {"FrictionThatFeedsEnergyIn", "coefficient = 12", "coefficient = -1", "coefficient = -1",
     "effect[2].coefficient", "-1", "a finite number >= 0, in N s/m",
     "give the torque per velocity; below zero it would feed energy in: where a fit gave that, the "
     "sign of the torque or of the velocity is wrong"},
    {"DryFrictionThatFeedsEnergyIn", "kind = \"viscous_friction\"\njoint = 2\ncoefficient = 12",
     "kind = \"coulomb_friction\"\njoint = 2\nlevel = -0.5", "level = -0.5", "effect[2].level",
     "-0.5", "a finite number >= 0, in N", "give the torque against the motion"},
    {"CouplingToItself", "kind = \"viscous_friction\"\njoint = 2\ncoefficient = 12",
     "kind = \"joint_coupling\"\njoint = 2\ncoefficient = 12\nlevel = 0\nsource_joint = 2",
     "source_joint", "effect[2].source_joint", "2, the effect's own joint", "another joint",
     "give the other joint"},
    {"CouplingToNoJoint", "kind = \"viscous_friction\"\njoint = 2\ncoefficient = 12",
     "kind = \"joint_coupling\"\njoint = 2\ncoefficient = 12\nlevel = 0\nsource_joint = 3",
     "source_joint", "effect[2].source_joint", "3", "a whole number from 1 to 2",
     "write such a number"},
    {"CouplingToHalfAJoint", "kind = \"viscous_friction\"\njoint = 2\ncoefficient = 12",
     "kind = \"joint_coupling\"\njoint = 2\ncoefficient = 12\nlevel = 0\nsource_joint = 1.5",
     "source_joint", "effect[2].source_joint", "1.5", "a whole number from 1 to 2",
     "write such a number"},
    {"FormatWithAPart", "format = 1\n", "format = 1.5\n", "format = 1.5", "format", "1.5",
     "a whole number from 1 to", "write such a number"},
    {"DelayThatIsTooLong", "kind = \"viscous_friction\"\njoint = 2\ncoefficient = 12",
     "kind = \"time_delay\"\njoint = 2\ndelay = 0.5", "delay = 0.5", "effect[2].delay",
     "a delay of 0.5 s on joint 2", "at most ", "correct the delay"},
    {"MomentsThatARobotFileCouldHave", "zz = 0.025, xy = 0.001, xz = 0.0, yz = -0.002",
     "zz = 0.009, xy = 0.0, xz = 0.0, yz = 0.0", "inertia_kg_m2", "joint[1].link.inertia_kg_m2",
     "a tensor that breaks the triangle inequality (principal moments 0.009, 0.02, 0.03;",
     "a positive definite tensor", "check the signs"},
    {"FrictionThatLocks", "kind = \"viscous_friction\"\njoint = 2\ncoefficient = 12",
     "kind = \"load_dependent_friction\"\njoint = 2\nfactor = 1.0", "factor", "effect[2].factor",
     "1", "a number from 0 to 0.95", "give the friction per torque"},
    {"FrictionsThatLockTogether", "kind = \"viscous_friction\"\njoint = 2\ncoefficient = 12",
     "kind = \"load_dependent_friction\"\njoint = 2\nfactor = 0.5\n\n[[effect]]\n"
     "kind = \"load_dependent_friction\"\njoint = 2\nfactor = 0.75",
     "factor = 0.75", "effect[3].factor", "friction by the load of this joint that adds up to 1.25",
     "at most 0.95 per joint", "make one effect of them"},
    // Bound.
    {"UnknownBound", "\"table\"", "\"tables\"", "tables", "uncertainty_bound.kind",
     "the string \"tables\"", "constant, scaled_norm, table;", "write \"table\""},
    {"BoundNotPositive", "value = [1.0, 2.5]", "value = [1.0, 0.0]", "value = [",
     "uncertainty_bound.value[2]", "0", "a finite number > 0", "write a number"},
    {"NegativeVelocityError", "value = [1.0, 2.5]", "value = [1.0, 2.5]\nvelocity_error = -0.1",
     "velocity_error", "uncertainty_bound.velocity_error", "-0.1", "a finite number >= 0",
     "write a number"},
    {"TableWithoutAValue", "value = [1.0, 2.5]", "value = [1.0]", "value = [",
     "uncertainty_bound.value", "a list of 1", "a list of 2 numbers", "write ["},
    {"TableNotRising", "at = [0.0, 10.0]", "at = [10.0, 10.0]", "at = [", "uncertainty_bound.at",
     "10 after 10", "strictly rising numbers", "sort the points"},
    {"TableOfAnUnknownJoint", "joint = 2\nat", "joint = 9\nat", "joint = 9",
     "uncertainty_bound.joint", "9", "a whole number from 1 to 2", "write such a number"},
    {"KeyOfAnotherBound", "variable = \"torque\"", "variable = \"torque\"\nscale = 2.0",
     "scale = 2", "uncertainty_bound.scale", "a key that a bound of kind table does not have",
     "kind, source", "remove it"},
};

INSTANTIATE_TEST_SUITE_P(RobotFile, Refusal, testing::ValuesIn(kMistakes),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(RobotFile, AcceptsTheSampleThatEveryMistakeStartsFrom) {
  EXPECT_EQ(refusal(test::kSampleRobot), "accepted");
}

// What is below zero only beside other friction, or either way, stays as it is.
TEST(RobotFile, TakesNumbersBelowZeroThatFitsFind) {
  const std::string viscous = "kind = \"viscous_friction\"\njoint = 2\ncoefficient = 12";
  for (const std::string effect :
       {"kind = \"viscous_friction\"\njoint = 2\ncoefficient = 0",
        "kind = \"quadratic_friction\"\njoint = 2\ncoefficient = -0.1",
        "kind = \"friction_asymmetry\"\njoint = 2\nlevel = -0.2\ncoefficient = -0.1",
        "kind = \"stribeck_friction\"\njoint = 2\nlevel = -0.1\nstribeck_velocity = 0.1",
        "kind = \"torque_offset\"\njoint = 2\nlevel = -0.4"}) {
    EXPECT_EQ(refusal(test::changed(test::kSampleRobot, viscous, effect)), "accepted") << effect;
  }
}

TEST(RobotFile, RefusesAKeyThatStandsTwice) {
  const std::string text = test::changed(test::kSampleRobot, "seed = 7", "seed = 7\nseed = 8");
  EXPECT_THAT(refusal(text), StartsWith("dir/r.toml: " + line_of(text, "seed = 8") +
                                        ": found text that is not TOML: "));
}

TEST(RobotFile, RefusesTextThatIsNotToml) {
  const std::string text = test::changed(test::kSampleRobot, "seed = 7", "seed 7");
  EXPECT_THAT(refusal(text), StartsWith("dir/r.toml: " + line_of(text, "seed 7") + ": found text"));
  EXPECT_THAT(refusal("\xff\xfe"), StartsWith("dir/r.toml: line 1: found text that is not TOML"));
  EXPECT_THAT(refusal(std::string(100000, '[')), StartsWith("dir/r.toml: line 1: found text"));
}

TEST(RobotFile, RefusesMoreEffectsThanTheModelHolds) {
  std::string text = test::kSampleRobot;
  const std::string effect = "[[effect]]\nkind = \"torque_offset\"\njoint = 1\nlevel = 0.5\n";
  for (int i = 0; i < 15; ++i) text += effect;
  EXPECT_THAT(refusal(text), HasSubstr("effect[17]: found 17 effects; allowed: at most 16"));
  text.resize(text.size() - effect.size());
  EXPECT_EQ(refusal(text), "accepted");
}

TEST(RobotFile, RefusesAMassThatLeavesNothingToMove) {
  // The slide weighs 1 kg; the payload hangs 0.1 m off, so that the turn feels it as well.
  const auto with_masses = [](const std::string& link, const std::string& payload) {
    return std::string(test::kSampleRobot) +
           "[[effect]]\nkind = \"link_mass\"\njoint = 2\nmass = " + link +
           "\n[[effect]]\nkind = \"tip_payload\"\njoint = 2\nmass = " + payload + "\nx = 0.1\n";
  };
  EXPECT_EQ(refusal(with_masses("-0.5", "-0.4")), "accepted");
  EXPECT_EQ(refusal(with_masses("-1.5", "0.6")), "accepted");
  const std::string heavy = with_masses("-0.25", "-0.8");
  EXPECT_THAT(refusal(heavy),
              StartsWith("dir/r.toml: " + line_of(heavy, "mass = -0.8") +
                         ", effect[4].mass: found -0.8, which leaves a mass matrix that is not "
                         "positive definite; allowed: a mass that leaves every joint"));
  const std::string link = with_masses("-1.2", "0.1");
  EXPECT_THAT(refusal(link), StartsWith("dir/r.toml: " + line_of(link, "mass = -1.2") +
                                        ", effect[3].mass: found -1.2, which leaves"));
}

// Only at one end of the range of the second joint is there too little left: its payload is heavier
// than nothing at the far end alone.
TEST(RobotFile, RefusesAMassThatLeavesNothingToMoveSomewhereInTheRange) {
  const auto arm = [](const std::string& limits) {
    return R"(format = 1
name = "arm"
gravity_m_s2 = [0.0, -9.81, 0.0]
[[joint]]
name = "a"
type = "revolute"
axis = [0.0, 0.0, 1.0]
[joint.link]
mass_kg = 1.0
centre_of_mass_m = [0.5, 0.0, 0.0]
[[joint]]
name = "b"
type = "prismatic"
axis = [1.0, 0.0, 0.0]
[joint.link]
mass_kg = 2.0
centre_of_mass_m = [0.0, 0.0, 0.0]
[joint.limits]
position = )" +
           limits +
           R"(
[[effect]]
kind = "tip_payload"
joint = 2
mass = -1.0
x = 1.0
)";
  };
  // About joint a: 0.25 + 2 b^2 - (b + 1)^2, above zero for b < -0.32 and b > 2.32 alone.
  EXPECT_EQ(refusal(arm("[2.5, 4.0]")), "accepted");
  EXPECT_THAT(refusal(arm("[2.2, 4.0]")), HasSubstr("effect[1].mass: found -1, which leaves"));
}

TEST(RobotFile, RefusesARobotWithoutJointsOrWithTooMany) {
  const std::string head = "format = 1\nname = \"r\"\ngravity_m_s2 = [0, 0, 0]\n";
  EXPECT_THAT(refusal(head), HasSubstr("joint: found 0 joints; allowed: 1 to 12 joints"));
  std::string text = head;
  for (int i = 0; i <= kMaxJoints; ++i) {
    text += "[[joint]]\nname = \"j" + std::to_string(i) +
            "\"\ntype = \"revolute\"\naxis = [1, 0, 0]\n[joint.link]\nmass_kg = 1\n"
            "centre_of_mass_m = [0, 0, 0]\n";
  }
  EXPECT_THAT(refusal(text), HasSubstr("joint: found 13 joints"));
  EXPECT_THAT(refusal(head + "joint = 3\n"),
              HasSubstr("joint: found 3; allowed: a list of tables"));
}

TEST(RobotFile, RefusesChannelsThatDoNotFitTheJoints) {
  const std::string text =
      test::changed(test::kSampleRobot, "position = [\"a\", \"b\"]", "position = [\"a\"]");
  EXPECT_THAT(refusal(text), HasSubstr("channels.position: found 1 entries"));
}

// A number may be written with or without a point.
TEST(WholeNumber, MayHaveAPoint) {
  std::string text = test::changed(test::kSampleRobot, "format = 1\n", "format = 1.0\n");
  text = test::changed(text, "joint = 2\ncoefficient", "joint = 2.0\ncoefficient");
  EXPECT_EQ(refusal(text), "accepted");
}

}  // namespace
}  // namespace offnominal::desk
