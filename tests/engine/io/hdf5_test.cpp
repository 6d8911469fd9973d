#include "engine/errors.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <csignal>
#include <malloc.h>
#include <numeric>
#include <sys/resource.h>

using namespace bris;

namespace {

/// Writes a file with one dataset of a thousand numbers and returns its content as bytes.
std::string sample(const std::filesystem::path& path) {
    std::vector<double> values(1000);
    std::iota(values.begin(), values.end(), 0.5);
    Hdf5File file = Hdf5File::create(path);
    file.write<double>("/deep/down/values", values);
    file.set_attribute("/deep", "name", std::string("sample"));
    file.close();
    return read_whole(path);
}

/// Reads everything in a sample file.
void read_all(const std::filesystem::path& path) {
    const Hdf5File file = Hdf5File::open(path);
    for (const std::string& name : file.names("/deep/down"))
        file.read<double>("/deep/down/" + name);
    file.text_attribute("/deep", "name");
}

/// Simulates a nearly full disk: while the object exists, files cannot grow beyond this size.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, signal_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
    rlimit before_{};
    void (*signal_)(int);
};

} // namespace

TEST_SUITE("engine/io/hdf5") {
    TEST_CASE("numbers of every type are read back unchanged") {
        const TemporaryDirectory directory;
        const std::vector<double> a{0.1, -1e300};
        const std::vector<float> b{0.5f, 2, 3, 4, 5, 6};
        const std::vector<std::int64_t> c{-1, std::int64_t{1} << 60};
        const std::vector<std::uint64_t> d{~std::uint64_t{0}};
        const std::vector<std::uint32_t> e{7};
        const std::vector<std::uint8_t> f{0, 255};
        {
            Hdf5File file = Hdf5File::create(directory / "new" / "a.h5");
            file.write<double>("/a", a);
            file.write<float>("/g/b", b, {1, 2, 3});
            file.write<std::int64_t>("/g/c", c);
            file.write<std::uint64_t>("/d", d);
            file.write<std::uint32_t>("/e", e);
            file.write<std::uint8_t>("/f", f);
            file.write<double>("/empty", std::span<const double>{});
            file.close();
        }
        const Hdf5File file = Hdf5File::open(directory / "new" / "a.h5");
        CHECK(file.read<double>("/a") == a);
        CHECK(file.read<float>("/g/b") == b);
        CHECK(file.shape("/g/b") == Hdf5File::Shape{1, 2, 3});
        CHECK(file.read<std::int64_t>("/g/c") == c);
        CHECK(file.read<std::uint64_t>("/d") == d);
        CHECK(file.read<std::uint32_t>("/e") == e);
        CHECK(file.read<std::uint8_t>("/f") == f);
        CHECK(file.read<double>("/empty").empty());
        CHECK(file.read<double>("/g/b")[0] == 0.5);
        CHECK(file.names("/g") == std::vector<std::string>{"b", "c"});
        CHECK(file.has("/g/b"));
        CHECK_FALSE(file.has("/g/x/y"));
    }

    TEST_CASE("rows can be appended to a growing dataset") {
        const TemporaryDirectory directory;
        Hdf5File file = Hdf5File::create(directory / "a.h5");
        file.make_growing<float>("/x", {3}, 2);
        file.append<float>("/x", std::vector<float>{1, 2, 3, 4, 5, 6});
        file.append<float>("/x", std::vector<float>{7, 8, 9});
        file.append<float>("/x", std::span<const float>{});
        CHECK(file.shape("/x") == Hdf5File::Shape{3, 3});
        CHECK(file.read<float>("/x") == std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9});
        CHECK_THROWS_AS(file.append<float>("/x", std::vector<float>{1, 2}), std::logic_error);
    }

    TEST_CASE("attributes can be numbers, lists and texts, and can be replaced") {
        const TemporaryDirectory directory;
        Hdf5File file = Hdf5File::create(directory / "a.h5");
        file.make_group("/meta");
        file.set_attribute("/meta", "text", std::string("first"));
        file.set_attribute("/meta", "text", std::string("grün"));
        file.set_attribute("/meta", "none", std::string());
        file.set_attribute("/meta", "number", 0.1);
        file.set_attribute("/meta", "list",
                           std::span<const std::int64_t>(std::vector<std::int64_t>{2, 0}));
        CHECK(file.text_attribute("/meta", "text") == "grün");
        CHECK(file.text_attribute("/meta", "none").empty());
        CHECK(file.attribute<double>("/meta", "number") == std::vector<double>{0.1});
        CHECK(file.attribute<std::int64_t>("/meta", "list") == std::vector<std::int64_t>{2, 0});
        CHECK(file.has_attribute("/meta", "list"));
        CHECK_FALSE(file.has_attribute("/meta", "other"));
        CHECK_FALSE(file.has_attribute("/other", "list"));
        CHECK_THROWS_AS(file.attribute<double>("/meta", "text"), OutputError);
        CHECK_THROWS_AS(file.text_attribute("/meta", "number"), OutputError);
    }

    TEST_CASE("a file truncated anywhere gives a one-line error") {
        const TemporaryDirectory directory;
        const std::string whole = sample(directory / "whole.h5");
        for (std::size_t length = 0; length < whole.size(); length += 97) {
            const auto path = directory / "cut.h5";
            write_whole(path, whole.substr(0, length));
            const std::string message = message_of<OutputError>([&] { read_all(path); });
            CAPTURE(length);
            CHECK(message.find(path.string()) != std::string::npos);
            CHECK(message.find('\n') == std::string::npos);
        }
    }

    TEST_CASE("a damaged file gives a one-line error or its data") {
        const TemporaryDirectory directory;
        const std::string whole = sample(directory / "whole.h5");
        for (std::size_t at = 0; at < whole.size(); at += 31) {
            std::string damaged = whole;
            damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
            write_whole(directory / "damaged.h5", damaged);
            try {
                read_all(directory / "damaged.h5");
            } catch (const OutputError& error) {
                CHECK(std::string(error.what()).find('\n') == std::string::npos);
            }
        }
    }

    TEST_CASE("a full disk causes an error at the write that does not fit, and no crash") {
        const TemporaryDirectory directory;
        const std::vector<float> frame(30000);
        std::size_t written = 0;
        {
            Hdf5File file = Hdf5File::create(directory / "a.h5");
            file.make_growing<float>("/x", {3}, 10000);
            const FileSizeLimit limit(std::size_t{1} << 20);
            CHECK_THROWS_AS(for (; written < 100; ++written) file.append<float>("/x", frame),
                            OutputError);
        }
        CHECK(written < 9); // 120 kB each
    }

    TEST_CASE("a file that grows by ever more groups does not need ever more memory") {
        const TemporaryDirectory directory;
        Hdf5File file = Hdf5File::create(directory / "a.h5");
        const std::vector<double> values(1000, 1.5);
        const auto grow = [&](int from, int to) {
            for (int k = from; k < to; ++k)
                for (const char* name : {"a", "b", "c", "d"}) {
                    const std::string dataset = fmt::format("/part_{}/{}", k, name);
                    file.make_growing<double>(dataset, {}, 1024);
                    file.append<double>(dataset, values);
                    file.flush();
                }
            return mallinfo2().uordblks; // bytes that are in use
        };
        const std::size_t before = grow(0, 100), after = grow(100, 400);
        CHECK(after < before + 300'000); // 12 MB more if the library chooses its cache
        file.close();
    }

    TEST_CASE("files of another format and missing files or objects are reported by name") {
        const TemporaryDirectory directory;
        write_whole(directory / "a.txt", "This is text, and long enough to hold a header or two.");
        const auto opening = [](const std::filesystem::path& path) {
            return message_of<OutputError>([&] { Hdf5File::open(path); });
        };
        CHECK(opening(directory / "a.txt") ==
              "cannot open '" + (directory / "a.txt").string() + "': file signature not found");
        CHECK(opening(directory / "b.h5") ==
              "cannot open '" + (directory / "b.h5").string() + "': No such file or directory");
        CHECK(message_of<OutputError>([] {
                  Hdf5File::create("/proc/none/a.h5");
              }).starts_with("cannot create '/proc/none/a.h5': "));
        sample(directory / "c.h5");
        const Hdf5File file = Hdf5File::open(directory / "c.h5");
        CHECK(message_of<OutputError>([&] {
                  file.read<double>("/other");
              }).starts_with("cannot open /other in '"));
        CHECK_THROWS_AS(file.read<double>("/deep"), OutputError);
        CHECK_THROWS_AS(file.names("/other"), OutputError);
        Hdf5File moved = Hdf5File::open(directory / "c.h5");
        CHECK_THROWS_AS(moved.make_group("/new"), OutputError); // opened for reading
    }
}
