#include <array>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "mujoco_handle.hpp"

namespace offnominal::sim {
namespace {

[[noreturn]] void throw_error(const char* message) {
  throw std::runtime_error(std::string("MuJoCo: ") + message);
}
void say_nothing(const char* /*message*/) {}

// Left alone it waits for a key at an error, and writes a file into the working folder at a
// warning. Warnings that matter are counted in its data.
void take_over_messages() {
  static std::once_flag once;
  std::call_once(once, [] {
    mju_user_error = throw_error;
    mju_user_warning = say_nothing;
  });
}

// What its parser keeps is global.
std::mutex& parser() {
  static std::mutex mutex;
  return mutex;
}

MujocoModelPointer load(const char* file, const mjVFS* files) {
  take_over_messages();
  std::array<char, 1000> error{};
  const std::lock_guard lock(parser());
  MujocoModelPointer model(mj_loadXML(file, files, error.data(), static_cast<int>(error.size())));
  if (!model) throw std::runtime_error(error.data());
  return model;
}

class FileInMemory {
 public:
  static constexpr const char* kName = "robot.xml";

  explicit FileInMemory(const std::string& text) : files_(std::make_unique<mjVFS>()) {
    mj_defaultVFS(files_.get());
    if (mj_makeEmptyFileVFS(files_.get(), kName, static_cast<int>(text.size())) != 0) {
      throw std::runtime_error("no room for the model");
    }
    std::memcpy(files_->filedata[mj_findFileVFS(files_.get(), kName)], text.data(), text.size());
  }
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;
  ~FileInMemory() { mj_deleteVFS(files_.get()); }

  [[nodiscard]] const mjVFS* get() const { return files_.get(); }

 private:
  std::unique_ptr<mjVFS> files_;
};

std::string name_of(const mjModel& model, int joint) {
  const char* const name = mj_id2name(&model, mjOBJ_JOINT, joint);
  return name != nullptr && *name != '\0' ? name : std::to_string(joint + 1);
}

std::vector<MujocoJoint> joints_of(const mjModel& model) {
  if (model.njnt == 0) throw std::runtime_error("no joint");
  std::vector<MujocoJoint> joints;
  for (int i = 0; i < model.njnt; ++i) {
    const int type = model.jnt_type[i];
    if (type != mjJNT_HINGE && type != mjJNT_SLIDE) {
      throw std::runtime_error("joint " + name_of(model, i) +
                               " has more than one axis: only hinges and slides have a drive");
    }
    joints.push_back({name_of(model, i), type == mjJNT_HINGE, model.dof_frictionloss[i],
                      model.dof_damping[i], model.dof_armature[i]});
  }
  if (model.njnt > kMaxJoints) {
    throw std::runtime_error(std::to_string(model.njnt) + " joints, " + std::to_string(kMaxJoints) +
                             " at most");
  }
  return joints;
}

}  // namespace

MujocoModel::MujocoModel(std::shared_ptr<const Handle> handle)
    : handle_(std::move(handle)), joints_(joints_of(*handle_->model)) {}

MujocoModel MujocoModel::from_text(const std::string& text) {
  const FileInMemory file(text);
  auto handle = std::make_shared<Handle>();
  handle->model = load(FileInMemory::kName, file.get());
  return MujocoModel(std::move(handle));
}

MujocoModel MujocoModel::from_file(const std::filesystem::path& file) {
  auto handle = std::make_shared<Handle>();
  handle->model = load(file.c_str(), nullptr);
  return MujocoModel(std::move(handle));
}

}  // namespace offnominal::sim
