#include "log/mat_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "log/read_log.hpp"
#include "support/recordings.hpp"

namespace {

using offnominal::desk::ChannelMap;
using offnominal::desk::InputError;
using offnominal::desk::is_mat_file;
using offnominal::desk::Log;
using offnominal::desk::read_log;
using offnominal::test::message_of;
using offnominal::test::recordings_dir;
using offnominal::test::TemporaryFile;
using ::testing::AllOf;
using ::testing::HasSubstr;

// Writes variables to a .mat file of level 5.
class MatWriter {
 public:
  explicit MatWriter(const std::string& name, matio_compression compression = MAT_COMPRESSION_ZLIB)
      : file_(name), compression_(compression) {
    mat_.reset(Mat_CreateVer(file_.path().c_str(), nullptr, MAT_FT_MAT5));
  }
  MatWriter& doubles(const char* name, std::size_t rows, std::size_t columns,
                     std::vector<double> values) {
    return write(name, MAT_C_DOUBLE, MAT_T_DOUBLE, rows, columns, values.data());
  }
  MatWriter& shorts(const char* name, std::vector<std::int16_t> values) {
    return write(name, MAT_C_INT16, MAT_T_INT16, 1, values.size(), values.data());
  }
  MatWriter& text(const char* name, std::string value) {
    return write(name, MAT_C_CHAR, MAT_T_UTF8, 1, value.size(), value.data());
  }
  const std::filesystem::path& path() {
    mat_.reset();
    return file_.path();
  }

 private:
  MatWriter& write(const char* name, matio_classes class_type, matio_types data_type,
                   std::size_t rows, std::size_t columns, void* data) {
    std::size_t dims[2] = {rows, columns};
    matvar_t* const variable = Mat_VarCreate(name, class_type, data_type, 2, dims, data, 0);
    EXPECT_EQ(Mat_VarWrite(mat_.get(), variable, compression_), 0);
    Mat_VarFree(variable);
    return *this;
  }

  TemporaryFile file_;
  matio_compression compression_;
  std::unique_ptr<mat_t, decltype(&Mat_Close)> mat_{nullptr, &Mat_Close};
};

std::vector<double> ramp(std::size_t size, double step) {
  std::vector<double> values(size);
  for (std::size_t i = 0; i < size; ++i) values[i] = step * static_cast<double>(i);
  return values;
}

ChannelMap drive_map() {
  ChannelMap map;
  map.time.source = "t";
  map.position.resize(1);
  map.position[0].source = "qm";
  map.velocity.resize(1);
  map.torque.resize(1);
  map.torque[0].source = "vir";
  map.torque[0].scale_source = "gtau";
  return map;
}

TEST(MatLog, VectorsOfAnyKindAndAScalarGainBecomeALog) {
  MatWriter mat("gain.mat");
  mat.doubles("t", 12, 1, ramp(12, 0.01)).doubles("qm", 1, 12, ramp(12, 0.5));
  mat.shorts("vir", std::vector<std::int16_t>(12, -3)).doubles("gtau", 1, 1, {35.5});
  mat.text("about", "a drive");
  const Log log = read_log(mat.path(), 1, drive_map());
  EXPECT_EQ(log.sample_count(), 12);
  EXPECT_DOUBLE_EQ(log.q(11, 0), 5.5);
  EXPECT_DOUBLE_EQ(log.tau(0, 0), -106.5);
}

TEST(MatLog, ColumnsOfAMatrixHaveNames) {
  MatWriter mat("matrix.mat");
  std::vector<double> both = ramp(10, 1);
  both.insert(both.end(), 10, 7.0);
  mat.doubles("t", 10, 1, ramp(10, 0.01)).doubles("q", 10, 2, both);
  ChannelMap map = drive_map();
  map.position[0].source = "q(:,1)";
  map.torque[0] = {"q(:,2)", 1, 0, "", ""};
  const Log log = read_log(mat.path(), 1, map);
  EXPECT_EQ(log.q(9, 0), 9);
  EXPECT_EQ(log.tau(9, 0), 7);
}

TEST(MatLog, CommonNamesNeedNoMap) {
  MatWriter mat("common.mat");
  mat.doubles("t", 10, 1, ramp(10, 0.01)).doubles("q1", 10, 1, ramp(10, 1));
  mat.doubles("tau1", 10, 1, ramp(10, 2)).doubles("kp", 1, 1, {3}).doubles("odd", 4, 1, ramp(4, 1));
  const Log log = read_log(mat.path(), 1, std::nullopt);
  EXPECT_EQ(log.tau(9, 0), 18);
  EXPECT_TRUE(log.extra.empty());
}

TEST(MatLog, MissingVariableListsThoseFound) {
  MatWriter mat("missing.mat");
  mat.doubles("t", 10, 1, ramp(10, 0.01)).doubles("q_m", 10, 1, ramp(10, 1)).text("about", "x");
  EXPECT_THAT(message_of<InputError>([&] { read_log(mat.path(), 1, drive_map()); }),
              AllOf(HasSubstr("t, q_m, about"), HasSubstr("\"qm\" for the position of joint 1")));
}

TEST(MatLog, WrongSizesAndKindsAreRefused) {
  MatWriter shorter("shorter.mat");
  shorter.doubles("t", 12, 1, ramp(12, 0.01)).doubles("qm", 1, 11, ramp(11, 0.5));
  EXPECT_THAT(message_of<InputError>([&] { read_log(shorter.path(), 1, drive_map()); }),
              AllOf(HasSubstr("variable qm"), HasSubstr("11 values"), HasSubstr("12")));

  MatWriter text("text.mat");
  text.doubles("t", 12, 1, ramp(12, 0.01)).text("qm", "abc");
  EXPECT_THAT(message_of<InputError>([&] { read_log(text.path(), 1, drive_map()); }),
              AllOf(HasSubstr("variable qm"), HasSubstr("text")));

  MatWriter scalar("scalar.mat");
  scalar.doubles("t", 12, 1, ramp(12, 0.01)).doubles("qm", 1, 1, {1});
  EXPECT_THAT(message_of<InputError>([&] { read_log(scalar.path(), 1, drive_map()); }),
              AllOf(HasSubstr("variable qm"), HasSubstr("a single number")));

  MatWriter gain("nogain.mat");
  gain.doubles("t", 12, 1, ramp(12, 0.01)).doubles("qm", 1, 12, ramp(12, 1));
  gain.doubles("vir", 1, 12, ramp(12, 1));
  EXPECT_THAT(message_of<InputError>([&] { read_log(gain.path(), 1, drive_map()); }),
              HasSubstr("\"gtau\" that scales the torque of joint 1"));

  MatWriter nan("nan.mat");
  auto values = ramp(12, 1);
  for (std::size_t i = 4; i < values.size(); ++i) values[i] = std::nan("");
  nan.doubles("t", 12, 1, ramp(12, 0.01)).doubles("qm", 1, 12, values);
  nan.doubles("vir", 1, 12, ramp(12, 1)).doubles("gtau", 1, 1, {2});
  EXPECT_THAT(message_of<InputError>([&] { read_log(nan.path(), 1, drive_map()); }),
              AllOf(HasSubstr("sample 5, position of joint 1"), HasSubstr("NaN")));
}

TEST(MatLog, DamagedFilesAreRefused) {
  const TemporaryFile garbage("garbage.mat", "this is no recording");
  EXPECT_TRUE(is_mat_file(offnominal::desk::RecordingFile(garbage.path())));
  EXPECT_THAT(message_of<InputError>([&] { read_log(garbage.path(), 1, drive_map()); }),
              HasSubstr("not a readable .mat file"));

  MatWriter mat("whole.mat");
  mat.doubles("t", 500, 1, ramp(500, 0.013)).doubles("qm", 500, 1, ramp(500, 0.7));
  std::ifstream input(mat.path(), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(input)), {});
  for (std::size_t size = 0; size < whole.size(); size += 97) {
    const TemporaryFile cut("cut.mat", whole.substr(0, size));
    EXPECT_THROW(read_log(cut.path(), 1, drive_map()), InputError) << size << " bytes";
  }
}

// A header may claim any number of columns; found by fuzzing, it took minutes and all memory.
TEST(MatLog, AMatrixThatClaimsMoreColumnsThanAnySignalIsRefusedAtOnce) {
  MatWriter mat("claims.mat", MAT_COMPRESSION_NONE);
  mat.doubles("t", 50, 1, ramp(50, 0.01)).doubles("qm", 50, 3, ramp(150, 0.7));
  std::ifstream input(mat.path(), std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(input)), {});
  const std::string size("\x32\0\0\0\x03\0\0\0", 8);  // 50 x 3
  const auto at = bytes.find(size);
  ASSERT_NE(at, std::string::npos);
  bytes[at + 7] = 0x40;  // 50 x 2^30
  const TemporaryFile claims("claims.mat", bytes);
  EXPECT_THAT(message_of<InputError>([&] { read_log(claims.path(), 1, drive_map()); }),
              HasSubstr("qm"));
}

TEST(MatLog, ContentDecidesBeforeTheExtension) {
  MatWriter mat("named.csv");
  mat.doubles("t", 10, 1, ramp(10, 0.01)).doubles("q1", 10, 1, ramp(10, 1));
  mat.doubles("tau1", 10, 1, ramp(10, 2));
  EXPECT_EQ(read_log(mat.path(), 1, std::nullopt).sample_count(), 10);
}

TEST(MatLog, PublishedRecordingHasItsPublishedColumns) {
  const auto file = recordings_dir() / "emps" / "DATA_EMPS.mat";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  const Log log = read_log(file, 1, drive_map());
  EXPECT_EQ(log.sample_count(), 24841);
  EXPECT_NEAR(log.period_s, 0.001, 1e-9);
  EXPECT_TRUE(log.remarks.empty());
  EXPECT_NEAR(log.q.maxCoeff(), 0.24637775, 1e-8);
  EXPECT_NEAR(log.tau.minCoeff(), -4.325661900120147 * 35.15065188248547, 1e-9);
}

}  // namespace
