#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

/// Why a file, or a column of it, cannot be read.
std::string complaint(const TemporaryDirectory& directory, std::string_view content,
                      const std::string& column = "") {
    const auto file = directory / "a.csv";
    write_whole(file, content);
    const std::string message = message_of<InputError>([&] {
        const CsvTable table = read_csv(file);
        if (!column.empty()) (void)table.column(column);
    });
    const std::string start = directory.path().string() + "/";
    return message.starts_with(start) ? message.substr(start.size()) : message;
}

} // namespace

TEST_SUITE("engine/io/csv") {
    TEST_CASE("columns are found by name, in a file with comments and missing values") {
        const TemporaryDirectory directory;
        write_whole(directory / "a.csv", "# source\nsize_mm, percent\r\n\n1e1,-\n+2.5,\n");
        const CsvTable table = read_csv(directory / "a.csv");
        CHECK(table.names == std::vector<std::string>{"size_mm", "percent"});
        CHECK(table.column("size_mm") == std::vector<double>{10, 2.5});
        CHECK(std::isnan(table.column("percent")[0]));
        CHECK(std::isnan(table.column("percent")[1]));
        CHECK(table.lines == std::vector<int>{4, 5});
        CHECK(table.has("percent"));
        CHECK_FALSE(table.has("other"));
    }

    TEST_CASE("a table that was written is read back with the same bits") {
        const TemporaryDirectory directory;
        const std::vector<std::vector<double>> rows{{0.1, 1e-300}, {-1.0 / 3, 5e15}};
        write_csv(directory / "new" / "b.csv", {"x", "y"}, rows, {"two rows"});
        const CsvTable table = read_csv(directory / "new" / "b.csv");
        CHECK(table.rows == rows);
        // no temporary file is left
        CHECK(std::distance(std::filesystem::directory_iterator(directory / "new"), {}) == 1);
        write_csv(directory / "c.csv", {"x"}, {{1.0 / 3}}, {}, 4);
        CHECK(read_whole(directory / "c.csv") == "x\n0.3333\n");
    }

    TEST_CASE("an error message names the file, the line, the column and what was found") {
        const TemporaryDirectory directory;
        CHECK(complaint(directory, "a,upper_percent\n1,2\n1,abc\n", "upper_percent") ==
              "a.csv:3: column 'upper_percent': expected a number, found \"abc\"");
        CHECK(complaint(directory, "a,b\n1,2,3\n") ==
              "a.csv:2: expected 2 columns (a, b), found 3");
        CHECK(complaint(directory, "a,a\n1,2\n", "a") ==
              "a.csv:1: column 'a': expected once, found twice");
        CHECK(complaint(directory, "1,2\n") == "a.csv:1: expected column names, found \"1,2\"");
        CHECK(complaint(directory, "# nothing\n") ==
              "a.csv:1: expected a line of column names, found none");
        write_whole(directory / "a.csv", "x,y\n");
        const CsvTable table = read_csv(directory / "a.csv");
        CHECK(message_of<InputError>([&] { table.column("z"); }) ==
              (directory / "a.csv").string() + ": expected a column 'z', found x, y");
    }

    TEST_CASE(
        "columns that nobody asks for may hold anything: texts, nothing, no name, or the name "
        "of another one") {
        const TemporaryDirectory directory;
        write_whole(directory / "a.csv", "a,clock,,ok,clock,\n1,12:00,x,true,,\n2,,,no,-,\n");
        const CsvTable table = read_csv(directory / "a.csv");
        CHECK(table.column("a") == std::vector<double>{1, 2});
        CHECK(table.has("ok"));
        CHECK(table.others({"a"}) == std::vector<std::string>{"clock", "ok"});
        CHECK(complaint(directory, read_whole(directory / "a.csv"), "ok") ==
              "a.csv:2: column 'ok': expected a number, found \"true\"");
        // with a map, too
        const CsvForm form{
            .columns = {{.ours = "t", .theirs = "a"}, {.ours = "x", .theirs = "ok"}}};
        const CsvTable mapped = read_csv(directory / "a.csv", form);
        CHECK(mapped.column("t") == std::vector<double>{1, 2});
        CHECK(
            message_of<InputError>([&] { (void)mapped.column("x"); }).ends_with("found \"true\""));
    }

    TEST_CASE("a file that cannot be read or written is an OutputError") {
        const TemporaryDirectory directory;
        CHECK_THROWS_AS(read_csv(directory / "none.csv"), OutputError);
        CHECK_THROWS_AS(read_csv(directory.path()), OutputError);
        CHECK_THROWS_AS(write_csv("/proc/none/a.csv", {"x"}, {{1.0}}), OutputError);
    }
}
