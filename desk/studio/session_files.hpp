#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "report/page.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// A file, and the name under which commands and messages speak of it.
struct NamedFile {
  std::string path;
  std::string name;
};

/// What a session begins with, as a command line would name it.
struct SessionFiles {
  NamedFile robot;
  std::vector<NamedFile> logs;
  std::vector<NamedFile> holdout = {};
  std::vector<RecordingPayload> payloads = {};  // by the recordings' names without folders
  std::optional<NamedFile> channels = {};       // none: the robot file's own
  std::string kept_as = {};        // beside which file the session is kept; empty: the first log
  std::string commands_note = {};  // what those who repeat the session have to know, or empty
  std::vector<std::string> commands_before = {};  // that make these files
  std::vector<report::EventMark> marks = {};      // of the first recording, in its time
};

/// Reads and examines them, as the verb does with those of its command line.
using OpenFiles = std::function<Input(const SessionFiles& files)>;

}  // namespace offnominal::desk::studio
