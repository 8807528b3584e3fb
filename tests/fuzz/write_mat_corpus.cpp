// Writes what the fuzzing of .mat files starts from, into the folder that is named: binaries are
// not kept in the tree.

#include <matio.h>

#include <array>
#include <cstdio>
#include <string>
#include <vector>

namespace {

// A structure with a cell array in it.
bool write_structure(mat_t* file, matio_compression compression) {
  std::array<std::size_t, 2> one{1, 1};
  double gain = 35;
  const auto number = [&] {
    return Mat_VarCreate("gain", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, one.data(), &gain, 0);
  };
  std::array<const char*, 2> fields{"gain", "notes"};
  matvar_t* about = Mat_VarCreateStruct("about", 2, one.data(), fields.data(), fields.size());
  if (about == nullptr) return false;
  std::array<matvar_t*, 1> notes{number()};
  Mat_VarSetStructFieldByName(about, "gain", 0, number());
  Mat_VarSetStructFieldByName(
      about, "notes", 0,
      Mat_VarCreate("notes", MAT_C_CELL, MAT_T_CELL, 2, one.data(), notes.data(), 0));
  const bool good = Mat_VarWrite(file, about, compression) == 0;
  Mat_VarFree(about);
  return good;
}

bool write(const std::string& path, matio_compression compression, std::size_t samples) {
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  if (file == nullptr) return false;
  bool good = true;
  const auto add = [&](const char* name, std::size_t columns) {
    std::vector<double> values(samples * columns);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.01 * static_cast<double>(i);
    std::array<std::size_t, 2> size{samples, columns};
    matvar_t* variable =
        Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0);
    good = good && variable != nullptr && Mat_VarWrite(file, variable, compression) == 0;
    Mat_VarFree(variable);
  };
  add("t", 1);
  for (const char* name : {"q1", "q2", "tau1", "tau2"}) add(name, 1);
  add("temp", 2);
  good = good && write_structure(file, compression);
  Mat_Close(file);
  return good;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  const std::string folder = arguments[1];
  const bool good = write(folder + "/plain.mat", MAT_COMPRESSION_NONE, 12) &&
                    write(folder + "/packed.mat", MAT_COMPRESSION_ZLIB, 12);
  if (!good) std::fprintf(stderr, "%s: cannot write\n", folder.c_str());
  return good ? 0 : 2;
}
