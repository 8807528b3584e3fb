// What MATLAB files hold in structures, by row, and as gains of several joints.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "desk/support/temporary_folder.hpp"
#include "log/mat_claims.hpp"
#include "log/read_log.hpp"
#include "robot/channels.hpp"
#include "support/recordings.hpp"

namespace {

using offnominal::desk::InputError;
using offnominal::desk::Log;
using offnominal::desk::parse_channels;
using offnominal::desk::read_log;
using offnominal::test::message_of;
using offnominal::test::recordings_dir;
using offnominal::test::TemporaryFile;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::size_t kSamples = 40;

matvar_t* matrix(const char* name, std::size_t rows, std::size_t columns,
                 std::vector<double> values) {
  std::array<std::size_t, 2> size{rows, columns};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0);
}

// A row per joint: 10 (joint + 1) + sample.
std::vector<double> joints_by_row(std::size_t joints) {
  std::vector<double> values;
  for (std::size_t i = 0; i < kSamples; ++i) {
    for (std::size_t joint = 0; joint < joints; ++joint) {
      values.push_back(10.0 * static_cast<double>(joint + 1) + static_cast<double>(i));
    }
  }
  return values;
}

std::vector<double> time() {
  std::vector<double> t(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) t[i] = 0.004 * static_cast<double>(i);
  return t;
}

// rec.kin.q (3 x n), rec.tau (n x 3), rec.t, para.u (3 x 1), two structures in run(1), run(2).
class Recording {
 public:
  Recording(mat_ft version, matio_compression compression) : file_("rec.mat") {
    mat_t* mat = Mat_CreateVer(file_.path().c_str(), nullptr, version);
    std::array<std::size_t, 2> one{1, 1};
    std::array<const char*, 3> of_rec{"kin", "tau", "t"};
    matvar_t* rec = Mat_VarCreateStruct("rec", 2, one.data(), of_rec.data(), of_rec.size());
    std::array<const char*, 1> of_kin{"q"};
    matvar_t* kin = Mat_VarCreateStruct("kin", 2, one.data(), of_kin.data(), of_kin.size());
    Mat_VarSetStructFieldByName(kin, "q", 0, matrix("q", 3, kSamples, joints_by_row(3)));
    Mat_VarSetStructFieldByName(rec, "kin", 0, kin);
    std::vector<double> tau(3 * kSamples, 1.5);
    Mat_VarSetStructFieldByName(rec, "tau", 0, matrix("tau", kSamples, 3, tau));
    Mat_VarSetStructFieldByName(rec, "t", 0, matrix("t", 1, kSamples, time()));
    write(mat, rec, compression);
    std::array<const char*, 1> of_para{"u"};
    matvar_t* para = Mat_VarCreateStruct("para", 2, one.data(), of_para.data(), of_para.size());
    Mat_VarSetStructFieldByName(para, "u", 0, matrix("u", 3, 1, {100, 200, 300}));
    write(mat, para, compression);
    std::array<std::size_t, 2> two{1, 2};
    matvar_t* run = Mat_VarCreateStruct("run", 2, two.data(), of_para.data(), of_para.size());
    Mat_VarSetStructFieldByName(run, "u", 0, matrix("u", 1, kSamples, time()));
    Mat_VarSetStructFieldByName(run, "u", 1,
                                matrix("u", 1, kSamples, std::vector<double>(kSamples, 7)));
    write(mat, run, compression);
    Mat_Close(mat);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return file_.path(); }

 private:
  static void write(mat_t* mat, matvar_t* variable, matio_compression compression) {
    EXPECT_EQ(Mat_VarWrite(mat, variable, compression), 0);
    Mat_VarFree(variable);
  }
  TemporaryFile file_;
};

Log read(const std::filesystem::path& path, const std::string& channels, int joints = 1) {
  return read_log(path, joints, parse_channels(toml::parse(channels), "robot.toml", joints));
}

TEST(MatStructures, FieldsRowsColumnsAndGainsHaveNames) {
  for (const auto& [version, compression] :
       {std::pair{MAT_FT_MAT5, MAT_COMPRESSION_NONE}, std::pair{MAT_FT_MAT5, MAT_COMPRESSION_ZLIB},
        std::pair{MAT_FT_MAT73, MAT_COMPRESSION_NONE}}) {
    const Recording recording(version, compression);
    const Log log = read(recording.path(),
                         "time = 'rec.t'\n"
                         "position = [{source = 'rec.kin.q(2,:)', unit = 'deg'}]\n"
                         "torque = [{source = 'rec.tau(:,3)', scale_source = 'para.u(2)'}]\n"
                         "[extra]\nother = 'run(2).u'\ncolumn = 'rec.kin.q(1,:)'");
    ASSERT_EQ(log.sample_count(), static_cast<Eigen::Index>(kSamples)) << version;
    EXPECT_NEAR(log.q(5, 0), 25 * 0.017453292519943295, 1e-12);
    EXPECT_EQ(log.tau(7, 0), 300);
    EXPECT_EQ(log.extra.at("other")[3], 7);
    EXPECT_EQ(log.extra.at("column")[3], 13);
  }
}

TEST(MatStructures, WhatIsMissingIsAnsweredWithWhatThereIs) {
  const Recording recording(MAT_FT_MAT5, MAT_COMPRESSION_ZLIB);
  EXPECT_THAT(message_of<InputError>([&] {
                read(recording.path(), "time = 'rec.t'\nposition = 'rec.q'\ntorque = 'rec.t'");
              }),
              AllOf(HasSubstr("rec.kin.q(1,:), rec.kin.q(2,:), rec.kin.q(3,:), rec.tau(:,1)"),
                    HasSubstr("run(1).u, run(2).u")));
  EXPECT_THAT(message_of<InputError>([&] {
                read(recording.path(), "time = 'rec.t'\nposition = 'rec'\ntorque = 'rec.t'");
              }),
              AllOf(HasSubstr("variable rec"), HasSubstr("a structure")));
}

// Where fewer numbers are stored than the dimensions claim, matio gives what was in memory before.
TEST(MatStructures, ClaimsInsideOfStructuresAreCheckedToo) {
  const Recording recording(MAT_FT_MAT5, MAT_COMPRESSION_NONE);
  EXPECT_FALSE(offnominal::desk::impossible_claim(recording.path()));
  std::string bytes = offnominal::test::content_of(recording.path());
  const std::string size("\x03\0\0\0\x28\0\0\0", 8);  // 3 x 40
  const auto at = bytes.find(size);
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 4;
  const TemporaryFile claims("claims.mat", bytes);
  const auto claim = offnominal::desk::impossible_claim(claims.path());
  ASSERT_TRUE(claim);
  EXPECT_EQ(claim->variable, "rec");
  EXPECT_THAT(claim->what, HasSubstr("160 values in 960 bytes"));
}

TEST(MatStructures, AnIndustrialArmsRecordingIsReadAsItWasPublished) {
  for (const char* name : {"A.mat", "B.mat", "C.mat"}) {
    const auto file = recordings_dir() / "kuka_kr300" / name;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
    const Log log =
        read(file,
             "time = 'rec.time_cont'\n"
             "position = [{source = 'rec.act_pos_mot_deg(1,:)', unit = 'deg'}]\n"
             "velocity = [{source = 'rec.act_vel_mot_deg_per_s(1,:)', unit = 'deg/s'}]\n"
             "torque = [{source = 'rec.act_torque_abs_nm(1,:)', "
             "scale_source = 'para.u(1)'}]");
    EXPECT_EQ(log.sample_count(), 2501);
    EXPECT_NEAR(log.period_s, 0.004, 1e-9);
    EXPECT_TRUE(log.remarks.empty());
    // Its velocity is the derivative of its position, in whatever unit both are.
    const double moved = log.q(2000, 0) - log.q(500, 0);
    EXPECT_NEAR(log.dq.col(0).segment(500, 1500).sum() * log.period_s, moved, 0.02);
  }
}

}  // namespace
