#include "log/csv_text.hpp"

#include <gtest/gtest.h>

#include "desk/support/temporary_folder.hpp"
#include "log/read_log.hpp"

namespace {

using namespace offnominal::desk;

Log some_log() {
  Log log;
  log.t_s = Eigen::VectorXd::LinSpaced(20, 0, 1.9);
  log.q = Eigen::MatrixXd::Random(20, 2);
  log.dq = Eigen::MatrixXd::Random(20, 2) / 3;
  log.tau = Eigen::MatrixXd::Random(20, 2) * 1e7;
  log.extra["temp1"] = Eigen::VectorXd::Random(20);
  return log;
}

TEST(CsvText, ReadsBackToTheBit) {
  const offnominal::test::TemporaryFolder folder;
  const Log log = some_log();
  offnominal::test::put(folder / "log.csv", csv_text(log));
  const Log back = read_log(folder / "log.csv", 2, std::nullopt);
  EXPECT_EQ(back.t_s, log.t_s);
  EXPECT_EQ(back.q, log.q);
  EXPECT_EQ(back.dq, log.dq);
  EXPECT_EQ(back.tau, log.tau);
  EXPECT_EQ(back.extra.at("temp1"), log.extra.at("temp1"));
  EXPECT_FALSE(back.dq_derived[0]);
}

TEST(CsvText, HeaderIsTheCommonOne) {
  const std::string text = csv_text(some_log());
  EXPECT_EQ(text.substr(0, text.find('\n')), "t,q1,q2,dq1,dq2,tau1,tau2,temp1");
}

}  // namespace
