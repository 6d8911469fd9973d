#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

const std::vector<KnownColumn> known{{"t", std::vector<ColumnUnit>{{"s"}, {"ms", 1e-3}}, true},
                                     {"ax", std::vector<ColumnUnit>{{"m/s2"}, {"g", 9.80665}}},
                                     {"temp", std::vector<ColumnUnit>{{"K"}, {"C", 1, 273.15}}},
                                     {"seq"}};

struct Files {
    TemporaryDirectory directory;

    CsvForm map(const std::string& text) const {
        write_whole(directory / "columns.txt", text);
        return read_column_map(directory / "columns.txt", known);
    }
    CsvTable table(const CsvForm& form, const std::string& text) const {
        write_whole(directory / "a.csv", text);
        return read_csv(directory / "a.csv", form);
    }
    std::string complaint(auto&& action) const {
        const std::string message = message_of<InputError>(action),
                          start = directory.path().string() + "/";
        std::string text = message.starts_with(start) ? message.substr(start.size()) : message;
        for (auto at = text.find(start); at != std::string::npos; at = text.find(start))
            text.erase(at, start.size());
        return text;
    }
};

} // namespace

TEST_SUITE("engine/io/column_map") {
    TEST_CASE("a file with other names, units, signs, delimiter and decimal sign is read through "
              "its column map") {
        const Files files;
        const CsvForm form = files.map("# of a data logger\ndelimiter = semicolon\ndecimal = "
                                       "comma\ncomment = %\nheader_line = 3\nfirst_line = 5\n"
                                       "t = \"Time, # [ms]\", ms\nax = -AccY, g  # its y points "
                                       "against our x\ntemp = \"-T\", C\n");
        const CsvTable table = files.table(
            form,
            "Logger 3; serial 0815\n% t; ax\nstate;\"Time, # [ms]\";AccX;AccY;-T;\n;ms;g;g;C;\n% "
            "begun\nok;1500,5;0,1;+0,5;20;\n\nlost;1,6e3;;;-;\n");
        CHECK(table.names == std::vector<std::string>{"t", "ax", "temp"});
        CHECK(table.lines == std::vector<int>{6, 8});
        CHECK(table.column("t")[0] == about(1.5005));
        CHECK(table.column("t")[1] == about(1.6));
        CHECK(table.column("ax")[0] == about(-0.5 * 9.80665));
        CHECK(std::isnan(table.column("ax")[1]));
        CHECK(table.column("temp")[0] == about(293.15));
        CHECK_FALSE(table.has("state"));
        CHECK(form.find("ax")->unit == "g");
        CHECK(form.find("seq") == nullptr);
    }

    TEST_CASE(
        "the column names are read from the line given in the map, also behind a comment sign") {
        const Files files;
        const CsvForm form = files.map("comment = %\nheader_line = 2\nt = \"% when\"\nax = a\n");
        CHECK(files.table(form, "% a logger\n% when,a\n% begun\n1,2\n").rows ==
              std::vector<std::vector<double>>{{1, 2}});
    }

    TEST_CASE("tabs and blanks are delimiters too, with any number of blanks in a row") {
        const Files files;
        const CsvTable blanks =
            files.table(files.map("delimiter = space\nt = when\nax = \"acc x\"\n"),
                        "  when  \"acc x\"   n\n 1   2 x\n\t3 4  -\n");
        CHECK(blanks.rows == std::vector<std::vector<double>>{{1, 2}, {3, 4}});
        const CsvTable tabs = files.table(files.map("delimiter = tab\nt = n, ms\nax = a b\n"),
                                          "a b\t\tn\n5\t\t1000\n\t\"x, y\"\t2000\n");
        CHECK(tabs.column("t") == std::vector<double>{1, 2});
        // a tab at the beginning of a line follows an empty cell
        CHECK(std::isnan(tabs.column("ax")[1]));
    }

    TEST_CASE("errors in a column map are reported with their line") {
        const Files files;
        const auto why = [&](const std::string& text) {
            return files.complaint([&] { (void)files.map(text); });
        };
        CHECK(why("t = T\nvx = V\n") ==
              "columns.txt:2: expected one of delimiter, decimal, comment, header_line, "
              "first_line, t, ax, temp, seq, found \"vx\"");
        CHECK(why("t = T\nax = A\nt = U\n") ==
              "columns.txt:3: t: expected once, found on line 1 already");
        CHECK(why("t = T\nax = T\n") ==
              "columns.txt:2: column 'T': expected under one name, found under t and ax");
        CHECK(why("ax = A\n") == "columns.txt: expected a line for 't', found none");
        CHECK(why("t = T, h\n") ==
              "columns.txt:1: expected a unit of t, one of s, ms, found \"h\"");
        CHECK(why("t = T\nseq = n, s\n") == "columns.txt:2: expected no unit for seq, found \"s\"");
        CHECK(why("t = T\nax =\n") == "columns.txt:2: expected a value for 'ax', found \"\"");
        CHECK(why("t = -\n") == "columns.txt:1: expected a column name, found \"-\"");
        CHECK(why("\nT\n") ==
              "columns.txt:2: expected a line `our name = their name, unit`, found \"T\"");
        CHECK(why("t = T\ndelimiter = ;\n") ==
              "columns.txt:2: expected one of comma, semicolon, tab, space, found \";\"");
        CHECK(why("t = T\ndecimal = comma\n") == "columns.txt: expected a delimiter different from "
                                                 "the decimal sign, found comma for both");
        CHECK(why("t = T\nheader_line = 0\n") ==
              "columns.txt:2: expected a line number, counted from 1, found \"0\"");
        CHECK(why("t = T\ndelimiter = semicolon\ncomment = ;\n") ==
              "columns.txt: expected a comment sign different from the delimiter, found ';' for "
              "both");
        CHECK(why("t = T\ncomment = .\n") ==
              "columns.txt: expected a comment sign different from the decimal sign, found '.' for "
              "both");
        CHECK(why("t = T\nheader_line = 4\nfirst_line = 4\n") ==
              "columns.txt: first_line: expected a line after the column names in line 4, found 4");
        CHECK(why("t = T\nfirst_line = 1\n") ==
              "columns.txt: first_line: expected a line after the column names in line 1, found 1");
        CHECK(why("t = T\nfirst_line = 2\n").empty());
        CHECK(why("t = T\ncomment = //\n") ==
              "columns.txt:2: expected a single character, found \"//\"");
    }

    TEST_CASE("a file that does not match its column map is rejected with its line and the line of "
              "the map") {
        const Files files;
        const CsvForm form = files.map("delimiter = semicolon\ndecimal = comma\nt = T\nax = A\n");
        const auto why = [&](const std::string& text) {
            return files.complaint([&] { (void)files.table(form, text).column("ax"); });
        };
        CHECK(why("T;B\n1;2\n") ==
              "a.csv:1: expected a column 'A' (ax of columns.txt:4), found T, B");
        CHECK(why("T;A;A\n1;2;3\n") == "a.csv:1: column 'A': expected once, found twice");
        CHECK(why("T;A\n1;2;3\n") == "a.csv:2: expected 2 columns (T, A), found 3");
        // a decimal point in a file with decimal commas
        CHECK(why("T;A\n1;2.5\n") == "a.csv:2: column 'A': expected a number, found \"2.5\"");
        CHECK(why("T;A\n1;high\n") == "a.csv:2: column 'A': expected a number, found \"high\"");
        const CsvForm late = files.map("first_line = 9\nt = T\n");
        CHECK(files.complaint([&] { (void)files.table(late, "T\n1\n2\n"); }) ==
              "a.csv: expected numbers from line 9 on (first_line), found none");
    }
}
