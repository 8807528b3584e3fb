#include "log/mat_claims.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>
#include <zlib.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "log/read_log.hpp"

namespace {

using offnominal::desk::impossible_claim;
using offnominal::desk::InputError;
using offnominal::desk::is_mat_level_5_or_7;
using offnominal::desk::read_log;
using offnominal::test::message_of;
using offnominal::test::TemporaryFile;
using ::testing::AllOf;
using ::testing::HasSubstr;

// Parts of a MATLAB file of level 5, in either byte order.
struct Bytes {
  bool big_endian = false;

  std::string word(std::uint32_t value) const {
    std::string bytes;
    for (int i = 0; i < 4; ++i) {
      bytes += static_cast<char>(value >> (8 * (big_endian ? 3 - i : i)));
    }
    return bytes;
  }
  std::string element(std::uint32_t type, const std::string& content) const {
    return word(type) + word(static_cast<std::uint32_t>(content.size())) + content +
           std::string((8 - content.size() % 8) % 8, '\0');
  }
  std::string array(std::uint32_t array_class, std::uint32_t rows, std::uint32_t columns,
                    const std::string& content) const {
    return element(14, element(6, word(array_class) + word(0)) +
                           element(5, word(rows) + word(columns)) + element(1, "c") + content);
  }
  std::string cells(std::uint32_t rows, std::uint32_t columns, const std::string& content) const {
    return array(1, rows, columns, content);
  }
  std::string numbers(std::uint32_t count) const {
    return array(6, count, 1, element(9, std::string(8 * std::size_t{count}, '\1')));
  }
  std::string structure(std::uint32_t elements, const std::string& names,
                        const std::string& content) const {
    const std::string name_size =
        big_endian ? std::string("\0\4\0\5", 4) : std::string("\5\0\4\0", 4);
    return array(2, elements, 1, name_size + word(4) + element(1, names) + content);
  }
  std::string packed(const std::string& array) const {
    uLongf size = compressBound(array.size());
    std::string content(size, '\0');
    compress(reinterpret_cast<Bytef*>(content.data()), &size,
             reinterpret_cast<const Bytef*>(array.data()), array.size());
    content.resize(size);
    return word(15) + word(static_cast<std::uint32_t>(size)) + content;
  }
  std::string file(const std::string& variables) const {
    std::string header = "MATLAB 5.0 MAT-file";
    header.resize(124, ' ');
    return header + (big_endian ? std::string("\1\0MI", 4) : std::string("\0\1IM", 4)) + variables;
  }
};

// What is claimed by this variable between two good ones, packed or not; "" for nothing.
std::string claim_of(const Bytes& bytes, const std::string& variable, bool packed) {
  const std::string between = packed ? bytes.packed(variable) : variable;
  const TemporaryFile file("claims.mat", bytes.file(bytes.numbers(9) + between + bytes.numbers(2)));
  const auto claim = impossible_claim(file.path());
  return claim ? claim->variable + ": " + claim->what : "";
}

class MatClaims : public ::testing::TestWithParam<std::tuple<bool, bool>> {
 protected:
  std::string claim(const std::string& variable) const {
    return claim_of(bytes_, variable, std::get<1>(GetParam()));
  }
  const Bytes bytes_{std::get<0>(GetParam())};
};

TEST_P(MatClaims, WhatIsThereIsNoClaim) {
  const std::string empty = bytes_.word(14) + bytes_.word(0);
  EXPECT_EQ(claim(bytes_.cells(0, 0, "")), "");
  EXPECT_EQ(claim(bytes_.cells(1, 3, bytes_.numbers(5) + empty + bytes_.numbers(70000))), "");
  const std::string two_fields("one\0two\0", 8);
  EXPECT_EQ(claim(bytes_.structure(2, two_fields,
                                   bytes_.numbers(1) + bytes_.cells(1, 1, bytes_.numbers(4)) +
                                       empty + bytes_.numbers(3))),
            "");
}

TEST_P(MatClaims, MoreElementsThanBytesAreNamed) {
  EXPECT_EQ(claim(bytes_.cells(1U << 24U, 6, bytes_.numbers(1))), "c: 100663296 cells in 72 bytes");
  EXPECT_EQ(claim(bytes_.structure(1U << 30U, std::string("one\0two\0", 8), bytes_.numbers(1))),
            "c: 2147483648 fields in 72 bytes");
  EXPECT_EQ(claim(bytes_.array(16, 1U << 31U, 1U << 31U, "")),
            "c: 4611686018427387904 function handles in 0 bytes");
}

TEST_P(MatClaims, TheyAreFoundWhereTheyAreNested) {
  EXPECT_EQ(claim(bytes_.cells(1, 2, bytes_.numbers(1) + bytes_.cells(9, 9, bytes_.numbers(2)))),
            "c: 81 cells in 80 bytes");
  const std::string huge = bytes_.array(6, 1U << 20U, 1, bytes_.element(9, "12345678"));
  EXPECT_EQ(claim(bytes_.cells(1, 1, huge)), "c: 1048576 values in 16 bytes");
  EXPECT_EQ(claim(huge), "c: 1048576 values in 8 bytes");
}

TEST_P(MatClaims, NestingHasAnEnd) {
  std::string nested = bytes_.numbers(1);
  for (int i = 0; i < 64; ++i) nested = bytes_.cells(1, 1, nested);
  EXPECT_EQ(claim(nested), "c: more than 64 levels");
}

TEST_P(MatClaims, AContainerThatEndsEarlyIsNamed) {
  std::string cells = bytes_.cells(1, 1, bytes_.element(9, "12345678"));
  EXPECT_EQ(claim(cells), "c: an element that is no array");
  cells = bytes_.cells(1, 1, bytes_.word(14) + bytes_.word(80));
  EXPECT_EQ(claim(cells), "c: an element of 80 bytes in 0 bytes");
}

INSTANTIATE_TEST_SUITE_P(ByteOrderAndPacking, MatClaims,
                         ::testing::Combine(::testing::Bool(), ::testing::Bool()));

TEST_P(MatClaims, AVariableOfNoContainerIsReadUpToItsName) {
  const std::string huge_rank = bytes_.word(14) + bytes_.word(64) +
                                bytes_.element(6, bytes_.word(6) + bytes_.word(0)) +
                                bytes_.word(5) + bytes_.word(1U << 31U) + std::string(40, '\1');
  EXPECT_EQ(claim(huge_rank), ": 536870912 dimensions in 40 bytes");
}

// matio reads what is there of a variable that is cut off, and calls the rest of its memory
// numbers.
TEST(MatClaimsOfFiles, AFileEndsWithAVariableAndNotInOne) {
  const Bytes bytes;
  const std::string numbers = bytes.numbers(9);
  for (const std::string& variable : {numbers, bytes.packed(numbers)}) {
    const std::string whole = bytes.file(numbers + variable);
    const std::size_t first = 128 + numbers.size();
    for (std::size_t size = 129; size <= whole.size(); ++size) {
      const TemporaryFile cut("cut.mat", whole.substr(0, size));
      EXPECT_EQ(impossible_claim(cut.path()).has_value(), size != first && size != whole.size())
          << size << " bytes of " << whole.size();
    }
  }
  const TemporaryFile text("text.mat", std::string(500, 'x'));
  EXPECT_FALSE(impossible_claim(text.path()));
  EXPECT_FALSE(is_mat_level_5_or_7(std::string(500, 'x')));
  EXPECT_TRUE(is_mat_level_5_or_7(bytes.file(numbers)));
}

TEST(MatClaimsOfFiles, APackedVariableHasToAgreeWithItsChecksum) {
  const Bytes bytes;
  std::string content;
  for (int i = 0; i < 800; ++i) content += static_cast<char>(i * i / 7);
  const std::string variable = bytes.packed(bytes.array(6, 100, 1, bytes.element(9, content)));
  const std::string whole = bytes.file(variable);
  int found = 0;
  for (std::size_t at = 136; at < whole.size(); ++at) {
    std::string wrong = whole;
    wrong[at] = static_cast<char>(wrong[at] ^ 0x10);
    const TemporaryFile file("wrong.mat", wrong);
    found += impossible_claim(file.path()) ? 1 : 0;
  }
  // Between the last code and the checksum some bits may be nobody's.
  EXPECT_GE(found, static_cast<int>(whole.size()) - 136 - 1) << "every byte of it counts";
}

TEST(MatClaimsOfFiles, NumbersAreAsManyAsTheDimensionsSay) {
  for (const bool big_endian : {false, true}) {
    const Bytes bytes{big_endian};
    const auto claim = [&](std::uint32_t array_class, std::uint32_t rows, const std::string& data) {
      const TemporaryFile file("few.mat", bytes.file(bytes.array(array_class, rows, 1, data)));
      const auto found = impossible_claim(file.path());
      return found ? found->what : "";
    };
    EXPECT_EQ(claim(6, 3, bytes.element(9, std::string(24, '\1'))), "");
    EXPECT_EQ(claim(6, 4, bytes.element(9, std::string(24, '\1'))), "4 values in 24 bytes");
    EXPECT_EQ(claim(6, 2, bytes.element(9, std::string(24, '\1'))), "2 values in 24 bytes");
    EXPECT_EQ(claim(6, 12, bytes.element(4, std::string(24, '\1'))), "") << "stored narrower";
    EXPECT_EQ(claim(6, 3, bytes.element(77, std::string(24, '\1'))), "numbers of an unknown type");
    EXPECT_EQ(claim(6, 0, ""), "");
    const std::string small = bytes.word(2U << 16U | 2U) + std::string("\1\2\0\0", 4);
    EXPECT_EQ(claim(9, 2, small), "") << "in the tag";
    EXPECT_EQ(claim(9, 3, small), "3 values in 2 bytes");
  }
}

// As matio itself writes it, read back through the whole reader.
TEST(MatClaimsOfFiles, ARecordingBesideAStructureIsRead) {
  for (const matio_compression compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    const TemporaryFile file("beside.mat");
    mat_t* const mat = Mat_CreateVer(file.path().c_str(), nullptr, MAT_FT_MAT5);
    const auto vector = [](const char* name, std::vector<double> values) {
      std::array<std::size_t, 2> size{values.size(), 1};
      return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0);
    };
    std::array<std::size_t, 2> one{1, 1};
    std::array<const char*, 2> fields{"gain", "notes"};
    matvar_t* const about = Mat_VarCreateStruct("about", 2, one.data(), fields.data(), 2);
    Mat_VarSetStructFieldByName(about, "gain", 0, vector("gain", {35, 36, 37}));
    std::array<matvar_t*, 1> notes{vector("first", {1})};
    Mat_VarSetStructFieldByName(
        about, "notes", 0,
        Mat_VarCreate("notes", MAT_C_CELL, MAT_T_CELL, 2, one.data(), notes.data(), 0));
    std::vector<double> ramp(20);
    for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = 0.01 * static_cast<double>(i);
    for (matvar_t* const variable :
         {vector("t", ramp), about, vector("q1", ramp), vector("tau1", ramp)}) {
      ASSERT_EQ(Mat_VarWrite(mat, variable, compression), 0);
      Mat_VarFree(variable);
    }
    Mat_Close(mat);
    EXPECT_EQ(read_log(file.path(), 1, std::nullopt).sample_count(), 20);
  }
}

TEST(MatClaimsOfFiles, TheReaderRefusesThem) {
  const Bytes bytes;
  const TemporaryFile file("claims.mat", bytes.file(bytes.cells(1U << 24U, 6, "")));
  EXPECT_THAT(message_of<InputError>([&] { read_log(file.path(), 1, std::nullopt); }),
              AllOf(HasSubstr("variable c"), HasSubstr("100663296 cells in 0 bytes"),
                    HasSubstr("a complete file")));
}

}  // namespace
