/// Pages say what their results say.
#include "experiment/pages.hpp"

#include <gtest/gtest.h>

#include "experiment/comparison.hpp"
#include "unit/experiment/fake_scenario.hpp"

namespace noctule::experiment {
namespace {

class Pages : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "fake");
    std::ofstream(folder_ / "fake" / "summary.csv")
        << "scenario,filter,parameters,metric,unit,n,diverged,mean,sd,ci95_low,ci95_high\n"
           "near,good,N=1,error,m,100,0,0.0121,0.005,0.0110,0.0132\n"
           "near,good,N=1,complete,1,100,0,0.99,0.1,0.97,1.01\n"
           "near,bad,,error,m,97,3,0.5,0.2,0.4,0.6\n"
           "near,good,N=8;mode=a,error,m,100,0,0.25,0.1,0.2,0.3\n";
    Comparison c;
    c.subject = {"near", "bad", ""};
    c.against = {"near", "good", "N=1"};
    c.metric = "error";
    c.unit = "m";
    c.difference = 0.4879;
    c.ci95 = {0.39, 0.59};
    c.percent = 4032.2;
    c.p_value = c.p_holm = 1e-9;
    std::ofstream comparisons(folder_ / "fake" / "comparisons.csv");
    write_comparisons(comparisons, std::vector<Comparison>{c});
    std::ofstream(folder_ / "fake.yaml")
        << kFakeExperiment
        << "references: [{source: table 1, filter: PF, parameters: \"\", scenario: near, "
           "metric: error, value: 0.0861, unit: m}]\n";
  }
  [[nodiscard]] std::string refreshed(const std::string& text) const {
    return refreshed_page("<!-- data {results: fake, experiment: fake.yaml, scenario: near} -->\n" + text,
                          folder_ / "page.md");
  }
  [[nodiscard]] std::string figure(const std::string& specification) const {
    const std::string text = refreshed("x <!-- figure " + specification + " -->old<!-- /figure --> y");
    const std::size_t begin = text.rfind("-->", text.find("<!-- /figure")) + 3;
    return text.substr(begin, text.find("<!-- /figure") - begin);
  }

  Folder folder_;
};

TEST_F(Pages, TablesAreMadeAnew) {
  const std::string block =
      "<!-- table\n"
      "columns:\n"
      "  - {title: ours, filter: good, parameters: \"N=1\"}\n"
      "  - {title: bad, filter: bad}\n"
      "  - {title: paper, source: table, filter: PF}\n"
      "rows:\n"
      "  - {title: \"error [cm]\", metric: error, unit: cm}\n"
      "  - {title: diverged, show: diverged}\n"
      "-->";
  const std::string fresh = refreshed(block + "\n| stale |\n<!-- /table -->\nbehind");
  EXPECT_NE(fresh.find("\n| | ours | bad | paper |\n|---|---|---|---|\n"
                       "| error [cm] | 1.21 [1.10, 1.32] | 50.00 [40.00, 60.00] | 8.61 |\n"
                       "| diverged | 0 | 3 | |\n<!-- /table -->\nbehind"),
            std::string::npos)
      << fresh;
  EXPECT_EQ(refreshed_page(fresh, folder_ / "page.md"), fresh);
}

TEST_F(Pages, RowsAndColumnsShareTheParameters) {
  const std::string fresh = refreshed(
      "<!-- table\ncolumns: [{title: a, filter: good, parameters: mode=a}]\n"
      "rows: [{title: eight, parameters: N=8, metric: error, unit: m}]\n-->\n<!-- /table -->");
  EXPECT_NE(fresh.find("| eight | 0.25 [0.20, 0.30] |"), std::string::npos) << fresh;
}

TEST_F(Pages, FiguresInTheText) {
  EXPECT_EQ(figure("{filter: good, parameters: \"N=1\", metric: error, unit: mm, decimals: 1}"), "12.1 [11.0, 13.2]");
  EXPECT_EQ(figure("{filter: good, parameters: \"N=1\", metric: error, unit: m, decimals: 4, show: mean}"), "0.0121");
  EXPECT_EQ(figure("{filter: good, parameters: \"N=1\", metric: error, unit: cm, decimals: 1, show: sd}"), "0.5");
  EXPECT_EQ(figure("{filter: bad, metric: error, show: n}"), "97");
  EXPECT_EQ(figure("{filter: good, parameters: \"N=1\", metric: complete, show: count}"), "99 of 100");
  EXPECT_EQ(figure("{filter: bad, metric: error, against: good, against_parameters: \"N=1\", unit: cm, decimals: 0, "
                   "show: difference}"),
            "49 [39, 59]");
  EXPECT_EQ(figure("{filter: bad, metric: error, against: good, against_parameters: \"N=1\", show: percent}"),
            "4032.2");
  EXPECT_EQ(figure("{filter: bad, metric: error, against: good, against_parameters: \"N=1\", show: p_holm}"),
            "< 0.001");
}

TEST_F(Pages, WhatIsNotInTheResultsIsRefusedWithItsLine) {
  const std::string missing = refusal([&] { static_cast<void>(figure("{filter: ugly, metric: error}")); });
  EXPECT_NE(missing.find("page.md:2: not in"), std::string::npos) << missing;
  EXPECT_NE(missing.find("filter 'ugly'"), std::string::npos) << missing;
  EXPECT_NE(refusal([&] { static_cast<void>(figure("{filtr: good}")); }).find("filtr"), std::string::npos);
  EXPECT_NE(refusal([&] { static_cast<void>(figure("{filter: bad, metric: error, unit: inch}")); }).find("inch"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              static_cast<void>(refreshed("\n<!-- table\nrows: []\n-->\n"));
            }).find("page.md:3: expected '<!-- /table -->'"),
            std::string::npos);
}

TEST_F(Pages, FiguresInTheOpenNeedSupport) {
  const std::string data = "<!-- data {results: fake} -->\n";
  EXPECT_TRUE(unsupported_figures("no data: 1.23 cm, 12 %").empty());
  EXPECT_EQ(unsupported_figures(data + "a\nwe get 1.23 cm"), std::vector<std::string>{"3: 1.23 cm"});
  EXPECT_EQ(unsupported_figures(data + "better by 76.12 %"), std::vector<std::string>{"2: 76.12 %"});
  EXPECT_EQ(unsupported_figures(data + "better by 76%"), std::vector<std::string>{"2: 76%"});
  EXPECT_TRUE(unsupported_figures(data + "95 % of 100 runs, section 2.3, `0.5 m`\n```\n--x 1.5 m\n```\n").empty());
  EXPECT_TRUE(
      unsupported_figures(data + "<!-- figure {} -->1.21 [1.1, 1.3]<!-- /figure --> cm, at least 1.1 cm").empty());
}

}  // namespace
}  // namespace noctule::experiment
