#include "datasets/table.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include "files.hpp"

namespace noctule::datasets {
namespace {

class TableTest : public testing::Test {
 protected:
  std::string refused(const std::string& content, const TableFormat& format) {
    const auto path = folder_.write("t.txt", content);
    return refusal([&] { Table(path, format); });
  }
  std::string place(int line) const { return (folder_.path() / "t.txt").string() + ":" + std::to_string(line) + ": "; }

  TemporaryFolder folder_;
  const TableFormat blanks_{.columns = {"a", "b"}};
  const TableFormat commas_{.columns = {"a", "b"}, .separator = ','};
};

TEST_F(TableTest, ReadsBlanksTabsCommasCommentsAndTheOtherLineEnd) {
  const Table blanks(folder_.write("a", "# c\r\n 1 \t 2.5 \r\n\r\n-3e2   4\r\n"),
                     {.columns = {"a", "b"}, .comment = '#'});
  ASSERT_EQ(blanks.rows(), 2);
  EXPECT_EQ(blanks(0, 1), 2.5);
  EXPECT_EQ(blanks(1, 0), -300.0);
  const Table commas(folder_.write("b", "\xEF\xBB\xBFx,y\n1, 2,word\n"),
                     {.columns = {"a", "b"}, .separator = ',', .header = "x,y", .text_columns = 1});
  ASSERT_EQ(commas.rows(), 1);
  EXPECT_EQ(commas(0, 1), 2.0);
  EXPECT_TRUE(commas.notes().empty());
}

TEST_F(TableTest, RefusesWhatIsNotAFiniteNumberNamingLineAndColumn) {
  for (const char* bad : {"nan", "inf", "-inf", "0x10", "1.5.2", "word", "1e999", "+1", "--1", "1a"}) {
    EXPECT_EQ(refused("1 2\n3 " + std::string(bad) + "\n5 6\n", blanks_),
              place(2) + "b: expected a finite number, got '" + bad + "'");
  }
  EXPECT_EQ(refused("1,2\n3,\n", commas_), place(2) + "b: expected a finite number, got ''");
}

TEST_F(TableTest, RefusesWrongColumnsAndHeaders) {
  EXPECT_EQ(refused("1 2\n3\n4 5\n", blanks_), place(2) + "expected 2 columns, got 1");
  EXPECT_EQ(refused("1 2\n3 4 5\n", blanks_), place(2) + "expected 2 columns, got 3");
  EXPECT_EQ(refused("1,2\n3,4,\n", commas_), place(2) + "expected 2 columns, got 3");
  EXPECT_EQ(refused("a;b\n1,2\n", {.columns = {"a", "b"}, .separator = ',', .header = "a,b"}),
            place(1) + "expected 'a,b', got 'a;b'");
}

TEST_F(TableTest, RefusesNothingAtAll) {
  EXPECT_EQ(refusal([&] { Table("", blanks_); }), "path: expected the path of a file, got an empty one");
  const std::string path = (folder_.path() / "t.txt").string();
  EXPECT_EQ(refused("", blanks_), path + ": expected at least one record, got none");
  EXPECT_EQ(refused("1 2", {.columns = {"a"}}), path + ": expected at least one record, got none");
  EXPECT_EQ(refusal([&] { Table(folder_.path() / "absent", blanks_); }),
            (folder_.path() / "absent").string() +
                ": expected a readable file, plain or gzip, got: No such file or directory");
  EXPECT_NE(refusal([&] {
              Table(folder_.path(), blanks_);
            }).find("expected a readable file, plain or gzip, got: Is a directory"),
            std::string::npos);
}

TEST_F(TableTest, LeavesOutALastLineThatWasCutOff) {
  const Table cut(folder_.write("a", "1 2\n3 4\n5"), blanks_);
  EXPECT_EQ(cut.rows(), 2);
  ASSERT_EQ(cut.notes().size(), 1u);
  EXPECT_NE(cut.notes()[0].find(":3: the last record was cut off"), std::string::npos);
  const Table whole(folder_.write("b", "1 2\n3 4"), blanks_);
  EXPECT_EQ(whole.rows(), 2);
  ASSERT_EQ(whole.notes().size(), 1u);
  EXPECT_NE(whole.notes()[0].find(":2: the last line has no end; taken as whole"), std::string::npos);
}

TEST_F(TableTest, ChecksIntegersMinimaTimesAndOrder) {
  const Table t(folder_.write("t.txt", "1 2.5\n3 -4\n3 1e300\n"), blanks_);
  EXPECT_EQ(t.integer(1, 0), 3);
  EXPECT_EQ(refusal([&] { static_cast<void>(t.integer(0, 1)); }), place(1) + "b: expected an integer, got 2.5");
  EXPECT_EQ(refusal([&] { static_cast<void>(t.integer(2, 1)); }), place(3) + "b: expected an integer, got 1e+300");
  EXPECT_EQ(refusal([&] { static_cast<void>(t.at_least(0.0, 1, 1)); }), place(2) + "b: expected at least 0, got -4");
  EXPECT_EQ(refusal([&] { static_cast<void>(t.utime(2, 1, 1.0)); }),
            place(3) + "b: expected a time within a thousand years, got 1e+300");
  EXPECT_EQ(t.utime(0, 1, 1e-3), 2500);
  t.require_ascending(0, true);
  EXPECT_EQ(refusal([&] { t.require_ascending(0, false); }), place(3) + "a: expected more than 3 as above, got 3");
  EXPECT_EQ(refusal([&] { t.require_ascending(1, true); }), place(2) + "b: expected at least 2.5 as above, got -4");
}

class CompressedTableTest : public TableTest {
 protected:
  std::string compressed() {
    const auto path = folder_.path() / "t.gz";
    gzFile file = gzopen(path.c_str(), "wb");
    for (int i = 0; i < 5000; ++i) gzprintf(file, "%d %d\n", i, (i * 7919) % 10007);
    gzclose(file);
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(CompressedTableTest, ReadsGzipAsIfItWerePlain) {
  const Table t(folder_.write("a.gz", compressed()), blanks_);
  EXPECT_EQ(t.rows(), 5000);
  EXPECT_EQ(t(4999, 0), 4999.0);
  EXPECT_TRUE(t.notes().empty());
}

TEST_F(CompressedTableTest, ReadsUpToTheLastWholeRecordOfATruncatedFile) {
  const std::string content = compressed();
  const Table t(folder_.write("a.gz", content.substr(0, content.size() / 2)), blanks_);
  EXPECT_GT(t.rows(), 1000);
  EXPECT_LT(t.rows(), 5000);
  for (int row = 0; row < t.rows(); ++row) ASSERT_EQ(t(row, 1), (row * 7919) % 10007);
  EXPECT_NE(t.notes().back().find("compressed file is cut off"), std::string::npos);
}

TEST_F(CompressedTableTest, RefusesDamagedBytes) {
  std::string content = compressed();
  for (std::size_t i = content.size() / 2; i < content.size() / 2 + 40; ++i) content[i] = static_cast<char>(i * 37);
  const auto path = folder_.write("a.gz", content);
  EXPECT_NE(refusal([&] { Table(path, blanks_); }).find(path.string()), std::string::npos);
}

}  // namespace
}  // namespace noctule::datasets
