#include "tests/performance/peers/bed.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>
#include <string>

namespace bris::peers {

Bed read_bed(const std::filesystem::path& path) {
    std::ifstream in(path);
    require(in.good(),
            fmt::format("{}: expected the file of a bed, found no readable file", path.string()));
    Bed bed;
    std::size_t count = 0, number = 1;
    std::string line;
    std::getline(in, line);
    std::istringstream head(line);
    require(bool(head >> count >> bed.box.x() >> bed.box.y() >> bed.box.z()),
            fmt::format("{}:1: expected the number of spheres and three sides (m), found '{}'",
                        path.string(), line));
    while (std::getline(in, line)) {
        ++number;
        std::istringstream words(line);
        Ball ball{};
        std::size_t rock = 0;
        require(words >> ball.centre.x() >> ball.centre.y() >> ball.centre.z() >> ball.radius &&
                    ball.radius > 0,
                fmt::format("{}:{}: expected x y z radius (m), found '{}'", path.string(), number,
                            line));
        bed.balls.push_back(ball);
        if (words >> rock) bed.rocks.push_back(rock);
    }
    require(bed.balls.size() == count && (bed.rocks.empty() || bed.rocks.size() == count),
            fmt::format("{}: expected {} spheres, found {}, {} of them in clumps", path.string(),
                        count, bed.balls.size(), bed.rocks.size()));
    return bed;
}

void write_bed(const std::filesystem::path& path, const Bed& bed) {
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
    std::ofstream out(path);
    out << fmt::format("{} {:.17g} {:.17g} {:.17g}\n", bed.balls.size(), bed.box.x(), bed.box.y(),
                       bed.box.z());
    for (std::size_t k = 0; k < bed.balls.size(); ++k) {
        const Ball& b = bed.balls[k];
        out << fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}", b.centre.x(), b.centre.y(),
                           b.centre.z(), b.radius);
        if (!bed.rocks.empty()) out << ' ' << bed.rocks[k];
        out << '\n';
    }
    out.flush();
    if (!out) throw OutputError(fmt::format("cannot write '{}'", path.string()));
}

} // namespace bris::peers
