#include "log/mat_log.hpp"

#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "common/error.hpp"
#include "log/mat_claims.hpp"

namespace offnominal::tools {
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

bool is_numeric_array(const matvar_t& variable) {
  return variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64 &&
         variable.isComplex == 0 && variable.rank == 2 && variable.dims[0] > 0 &&
         variable.dims[1] > 0 &&
         (variable.dims[0] == 1 || variable.dims[1] == 1 || variable.dims[1] <= kMostColumns);
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
  return variable.dims[1] > kMostColumns
             ? "a matrix of " + std::to_string(variable.dims[1]) + " columns"
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
      if (info->name != nullptr) read_variable(*info);
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

  void read_variable(matvar_t& info) {
    const std::string name = info.name;
    if (!is_numeric_array(info)) {
      result_.names.push_back(name);
      if (is_required(need_of_(name))) {
        fail("variable " + name, kind_of(info), "a real vector or matrix");
      }
      return;
    }
    const std::size_t rows = info.dims[0];
    const std::size_t columns = info.dims[1];
    const bool matrix = rows > 1 && columns > 1;
    bool wanted = false;
    const std::size_t first_name = result_.names.size();
    for (std::size_t i = 0; i < (matrix ? columns : 1); ++i) {
      result_.names.push_back(matrix ? name + "(:," + std::to_string(i + 1) + ")" : name);
      wanted = wanted || need_of_(result_.names.back()) != Need::kNone;
    }
    if (!wanted) return;
    const auto claimed = static_cast<double>(rows) * static_cast<double>(columns);
    if (claimed > static_cast<double>(kMostPerPackedByte * std::filesystem::file_size(path_))) {
      fail("variable " + name, "more values than the file can hold", "a complete file");
    }
    const std::size_t size = rows * columns;
    if (Mat_VarReadDataAll(mat_.get(), &info) != 0 || info.data == nullptr ||
        info.nbytes != size * static_cast<std::size_t>(info.data_size)) {
      fail("variable " + name, "damaged data", "a complete file");
    }
    const std::optional<Eigen::VectorXd> values = numbers_of(info, size);
    if (!values) fail("variable " + name, kind_of(info), "a real vector or matrix");
    if (size == 1) {
      result_.scalars[name] = (*values)[0];
    } else if (!matrix) {
      result_.columns[name] = *values;
    } else {
      const auto height = static_cast<Eigen::Index>(rows);
      for (std::size_t i = 0; i < columns; ++i) {
        result_.columns[result_.names[first_name + i]] =
            values->segment(static_cast<Eigen::Index>(i) * height, height);
      }
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
  std::string extension = file.path().extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".mat";
}

NamedColumns read_mat(RecordingFile& file, const ChannelMap* /*channels*/, const NeedOf& need_of) {
  return MatReader(file, need_of).read();
}

}  // namespace offnominal::tools
