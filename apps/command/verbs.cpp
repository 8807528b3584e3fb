#include "command/verbs.hpp"

#include <array>

namespace offnominal::desk {
namespace {

constexpr std::array<Verb, 18> kVerbs = {{
    {"add", "Fit an effect to a recording and write the robot file that has it", set_up_add},
    {"calibrate", "Find the uncertainty bound from recordings of the healthy robot",
     set_up_calibrate},
    {"campaign", "Run a robot with faults by the thousand, and say which detector sees what",
     set_up_campaign},
    {"codegen", "Write a robot file as a C++ header of constants for firmware", set_up_codegen},
    {"compare", "Compare a model with a recording: error per joint, and what it follows",
     set_up_compare},
    {"explain", "Say which physical effect a model lacks, by recordings, with the evidence",
     set_up_explain},
    {"export-mjcf", "Write a robot file as MJCF, for MuJoCo, with the friction that was found",
     set_up_export_mjcf},
    {"export-urdf", "Write a robot file as URDF, with the friction that was found",
     set_up_export_urdf},
    {"identify", "Find inertia of every link and friction of every drive in recordings",
     set_up_identify},
    {"import-urdf", "Write a robot file from a URDF's chain of links", set_up_import_urdf},
    {"look", "Show what a recording holds, and the [channels] that would read it", set_up_look},
    {"motion", "Write a motion that tells effects apart, or shows what recordings did not",
     set_up_motion},
    {"new", "Write a robot file with the geometry of a DH table, and blanks for the rest",
     set_up_new},
    {"paper", "Run the paper's experiment: faults of a two-link arm, detected and accommodated",
     set_up_paper},
    {"replay", "Run the on-board monitor over a recording: residual, threshold, alarms",
     set_up_replay},
    {"sil", "Run controller and arm at the two ends of a CAN bus, with faults", set_up_sil},
    {"studio", "Look, learn, add and watch the error fall, in one page on this machine",
     set_up_studio},
    {"tune", "Find the monitor's settings in recordings of the healthy robot", set_up_tune},
}};

}  // namespace

std::span<const Verb> all_verbs() { return kVerbs; }

}  // namespace offnominal::desk
