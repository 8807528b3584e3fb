#include "log/mat_log.hpp"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "log/mat_claims.hpp"

namespace offnominal::desk {
namespace {

using Mat = std::unique_ptr<mat_t, decltype(&Mat_Close)>;
using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

template <typename Source>
Eigen::VectorXd as_doubles(const void* data, std::size_t size) {
  return Eigen::Map<const Eigen::Matrix<Source, Eigen::Dynamic, 1>>(
             static_cast<const Source*>(data), static_cast<Eigen::Index>(size))
      .template cast<double>();
}

std::optional<Eigen::VectorXd> numbers_of(const matvar_t& variable, std::size_t size) {
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      return as_doubles<double>(variable.data, size);
    case MAT_C_SINGLE:
      return as_doubles<float>(variable.data, size);
    case MAT_C_INT8:
      return as_doubles<std::int8_t>(variable.data, size);
    case MAT_C_UINT8:
      return as_doubles<std::uint8_t>(variable.data, size);
    case MAT_C_INT16:
      return as_doubles<std::int16_t>(variable.data, size);
    case MAT_C_UINT16:
      return as_doubles<std::uint16_t>(variable.data, size);
    case MAT_C_INT32:
      return as_doubles<std::int32_t>(variable.data, size);
    case MAT_C_UINT32:
      return as_doubles<std::uint32_t>(variable.data, size);
    case MAT_C_INT64:
      return as_doubles<std::int64_t>(variable.data, size);
    case MAT_C_UINT64:
      return as_doubles<std::uint64_t>(variable.data, size);
    default:
      return std::nullopt;
  }
}

// More than any recording has signals; a damaged header claims any number.
constexpr std::size_t kMostColumns = 4096;
// Values of a vector that may each be asked for alone.
constexpr Eigen::Index kMostGains = 64;
// Structures in one array, and in each other.
constexpr std::size_t kMostStructures = 64;
constexpr int kMostNested = 16;

bool is_numeric_array(const matvar_t& variable) {
  return variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64 &&
         variable.isComplex == 0 && variable.rank == 2 && variable.dims[0] > 0 &&
         variable.dims[1] > 0 && std::min(variable.dims[0], variable.dims[1]) <= kMostColumns;
}

std::string kind_of(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_CELL:
      return "a cell array";
    case MAT_C_STRUCT:
      return "a structure";
    case MAT_C_OBJECT:
    case MAT_C_OPAQUE:
      return "an object";
    case MAT_C_CHAR:
      return "text";
    case MAT_C_SPARSE:
      return "a sparse matrix";
    default:
      break;
  }
  if (variable.isComplex != 0) return "complex numbers";
  if (variable.rank != 2) return "an array of more than two dimensions";
  return std::min(variable.dims[0], variable.dims[1]) > kMostColumns
             ? fmt::format("a matrix of {} by {}", variable.dims[0], variable.dims[1])
             : "an empty array";
}

class MatReader {
 public:
  MatReader(RecordingFile& file, const NeedOf& need_of)
      : name_(file.name()), need_of_(need_of), mat_(nullptr, &Mat_Close) {
    // Before a pipe is copied, which may be long.
    if (!is_mat_level_5_or_7(file.beginning())) refuse_file();
    path_ = file.seekable();
    if (const auto claim = impossible_claim(path_)) {
      fail(claim->variable.empty() ? "" : "variable " + claim->variable, claim->what,
           "a complete file");
    }
    // matio prints to stderr by itself otherwise; what is wrong is said by the exception.
    Mat_LogInitFunc("offnominal", [](int, char*) {});
    mat_.reset(Mat_Open(path_.c_str(), MAT_ACC_RDONLY));
    if (!mat_) refuse_file();
  }

  NamedColumns read() {
    result_.file = name_;
    result_.place_of = [](Eigen::Index row) { return "sample " + std::to_string(row + 1); };
    while (true) {
      const Variable info(Mat_VarReadNextInfo(mat_.get()), &Mat_VarFree);
      if (!info) break;
      if (info->name != nullptr) read_named(*info, info->name, 0);
    }
    if (result_.names.empty()) fail("", "no variables", "at least time, position and torque");
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& found,
                         const std::string& allowed) const {
    throw InputError({name_, place, found, allowed, ""});
  }

  [[noreturn]] void refuse_file() const {
    fail("", "a file that is not a readable .mat file", "MATLAB level 5 or 7.3");
  }

  // A variable, or what a structure holds under its name.
  void read_named(matvar_t& info, const std::string& name, int depth) {
    if (info.class_type == MAT_C_STRUCT && depth < kMostNested) {
      read_structure(info, name, depth);
    } else {
      read_variable(info, name);
    }
  }

  // Fields are "name.field", those of the second of several structures "name(2).field".
  void read_structure(matvar_t& info, const std::string& name, int depth) {
    refuse_if_required(info, name);
    const unsigned fields = Mat_VarGetNumberOfFields(&info);
    const char* const* const names = Mat_VarGetStructFieldnames(&info);
    std::size_t count = info.rank > 0 ? 1 : 0;
    for (int i = 0; i < info.rank; ++i) count *= info.dims[i];
    if (count == 0 || count > kMostStructures || fields == 0 || names == nullptr) {
      result_.names.push_back(name);
      return;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const std::string of = count == 1 ? name : name + "(" + std::to_string(k + 1) + ")";
      for (unsigned i = 0; i < fields; ++i) {
        matvar_t* const field = Mat_VarGetStructFieldByIndex(&info, i, k);
        if (field == nullptr || names[i] == nullptr) continue;
        read_named(*field, of + "." + names[i], depth + 1);
      }
    }
  }

  void refuse_if_required(const matvar_t& info, const std::string& name) const {
    if (!is_required(need_of_(name))) return;
    fail("variable " + name, kind_of(info), "a real vector or matrix");
  }

  void read_variable(matvar_t& info, const std::string& name) {
    if (!is_numeric_array(info)) {
      result_.names.push_back(name);
      refuse_if_required(info, name);
      return;
    }
    const auto rows = static_cast<Eigen::Index>(info.dims[0]);
    const auto columns = static_cast<Eigen::Index>(info.dims[1]);
    const bool matrix = rows > 1 && columns > 1;
    std::vector<Part> wanted;
    const auto want = [&](Part part) {
      if (need_of_(part.name) != Need::kNone) wanted.push_back(std::move(part));
    };
    const auto number = [](Eigen::Index i) { return std::to_string(i + 1); };
    if (!matrix) {
      result_.names.push_back(name);
      want({name, 0, 1, rows * columns});
      // Gains of a few joints come as one vector.
      for (Eigen::Index i = 0;
           rows * columns > 1 && rows * columns <= kMostGains && i < rows * columns; ++i) {
        Part gain{name + "(" + number(i) + ")", i, 1, 1};
        if (is_required(need_of_(gain.name))) wanted.push_back(std::move(gain));
      }
    } else {
      // Named the way in which there are fewer; either way is there for whoever asks.
      const bool by_row = rows < columns;
      for (Eigen::Index i = 0; i < columns && info.dims[1] <= kMostColumns; ++i) {
        Part column{name + "(:," + number(i) + ")", i * rows, 1, rows};
        if (!by_row) result_.names.push_back(column.name);
        if (!by_row || is_required(need_of_(column.name))) want(std::move(column));
      }
      for (Eigen::Index i = 0; i < rows && info.dims[0] <= kMostColumns; ++i) {
        Part row{name + "(" + number(i) + ",:)", i, rows, columns};
        if (by_row) result_.names.push_back(row.name);
        if (by_row || is_required(need_of_(row.name))) want(std::move(row));
      }
    }
    if (!wanted.empty()) read_parts(info, name, wanted);
  }

  // What is taken of an array: every `step`th value from `first` on, `count` of them.
  struct Part {
    std::string name;
    Eigen::Index first;
    Eigen::Index step;
    Eigen::Index count;
  };

  void read_parts(matvar_t& info, const std::string& name, const std::vector<Part>& parts) {
    const auto claimed = static_cast<double>(info.dims[0]) * static_cast<double>(info.dims[1]);
    if (claimed > static_cast<double>(kMostPerPackedByte * std::filesystem::file_size(path_))) {
      fail("variable " + name, "more values than the file can hold", "a complete file");
    }
    const std::size_t size = info.dims[0] * info.dims[1];
    if (Mat_VarReadDataAll(mat_.get(), &info) != 0 || info.data == nullptr ||
        info.nbytes != size * static_cast<std::size_t>(info.data_size)) {
      fail("variable " + name, "damaged data", "a complete file");
    }
    const std::optional<Eigen::VectorXd> values = numbers_of(info, size);
    if (!values) fail("variable " + name, kind_of(info), "a real vector or matrix");
    for (const Part& part : parts) {
      if (part.count == 1) {
        result_.scalars[part.name] = (*values)[part.first];
        continue;
      }
      result_.columns[part.name] = (*values)(Eigen::seqN(part.first, part.count, part.step));
    }
  }

  std::string name_;
  std::filesystem::path path_;
  const NeedOf& need_of_;
  Mat mat_;
  NamedColumns result_;
};

}  // namespace

bool is_mat_file(const RecordingFile& file) {
  if (file.beginning().starts_with("MATLAB")) return true;
  return extension_of(file.path()) == ".mat";
}

NamedColumns read_mat(RecordingFile& file, const ChannelMap* /*channels*/, const NeedOf& need_of) {
  return MatReader(file, need_of).read();
}

}  // namespace offnominal::desk
