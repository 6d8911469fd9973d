#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/rocks/raw_mesh.hpp"
#include "scenarios/rocks/read_mesh.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <optional>
#include <sstream>
#include <string_view>

namespace bris {

namespace {

enum class Encoding { text, little, big };

/// A scalar type of the format, by either of its two names.
enum class Kind { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Kind> kind_named(const std::string& name) {
    constexpr std::array<std::array<const char*, 2>, 8> names{{{"char", "int8"},
                                                               {"uchar", "uint8"},
                                                               {"short", "int16"},
                                                               {"ushort", "uint16"},
                                                               {"int", "int32"},
                                                               {"uint", "uint32"},
                                                               {"float", "float32"},
                                                               {"double", "float64"}}};
    for (std::size_t k = 0; k < names.size(); ++k)
        if (name == names[k][0] || name == names[k][1]) return static_cast<Kind>(k);
    return {};
}

struct Property {
    std::string name;
    Kind kind;
    std::optional<Kind> count = {}; ///< of a list: type of its length
};

struct Element {
    std::string name;
    std::size_t rows;
    std::vector<Property> properties;
};

class PlyReader {
public:
    PlyReader(const std::filesystem::path& path, std::string_view bytes)
        : path_(path), bytes_(bytes) {
        mesh_.path = path;
    }

    RawMesh read() {
        read_header();
        mesh_.binary = encoding_ != Encoding::text;
        ++line_; // the first row is on the line after the header
        for (const Element& element : elements_)
            for (std::size_t row = 0; row < element.rows; ++row) read_row(element, row);
        return std::move(mesh_);
    }

private:
    [[noreturn]] void refuse(const std::string& what) const {
        throw InputError(fmt::format("{}:{}: PLY: {}", path_.string(), line_, what));
    }

    std::string next_line() {
        const std::size_t end = bytes_.find('\n', at_);
        if (end == std::string_view::npos) refuse("expected end_header, found the end of the file");
        std::string line(bytes_.substr(at_, end - at_));
        at_ = end + 1;
        ++line_;
        return line;
    }

    void read_header() {
        for (std::string word; word != "end_header";) {
            std::istringstream words(next_line());
            word.clear();
            words >> word;
            if (line_ == 1 && word != "ply") refuse("expected \"ply\", found \"" + word + "\"");
            if (word == "format") read_format(words);
            if (word == "element") read_element(words);
            if (word == "property") read_property(words);
        }
        if (!encoding_) refuse("expected a line \"format\" in the header, found none");
    }

    void read_format(std::istream& words) {
        std::string name;
        words >> name;
        if (name == "ascii") encoding_ = Encoding::text;
        if (name == "binary_little_endian") encoding_ = Encoding::little;
        if (name == "binary_big_endian") encoding_ = Encoding::big;
        if (!encoding_)
            refuse("expected format ascii, binary_little_endian or binary_big_endian, found \"" +
                   name + "\"");
    }

    void read_element(std::istream& words) {
        Element element;
        std::int64_t rows = 0;
        if (!(words >> element.name >> rows)) refuse("expected \"element NAME COUNT\"");
        if (rows < 0 || rows > std::ssize(bytes_)) // each row takes at least one byte
            refuse(fmt::format("element {}: expected at most {} rows in a file of this size, "
                               "found {}",
                               element.name, bytes_.size(), rows));
        element.rows = static_cast<std::size_t>(rows);
        elements_.push_back(std::move(element));
    }

    void read_property(std::istream& words) {
        if (elements_.empty()) refuse("expected an element before its properties");
        const auto kind = [&](const std::string& name) {
            const auto found = kind_named(name);
            if (!found) refuse("expected a type such as float or uchar, found \"" + name + "\"");
            return *found;
        };
        std::string type, counts, name;
        words >> type;
        const bool is_list = type == "list";
        if (is_list) words >> counts >> type;
        if (!(words >> name)) refuse("expected \"property TYPE NAME\"");
        Property property{.name = name, .kind = kind(type)};
        if (is_list) property.count = kind(counts);
        elements_.back().properties.push_back(property);
    }

    template <class T>
    double scalar() {
        std::array<char, sizeof(T)> raw;
        if (at_ + raw.size() > bytes_.size())
            refuse("expected more data, found the end of the file");
        std::memcpy(raw.data(), bytes_.data() + at_, raw.size());
        at_ += raw.size();
        if ((encoding_ == Encoding::big) != (std::endian::native == std::endian::big))
            std::ranges::reverse(raw);
        return static_cast<double>(std::bit_cast<T>(raw));
    }

    double word() {
        const auto is_blank = [](char c) {
            return c == ' ' || c == '\t' || c == '\r' || c == '\n';
        };
        for (; at_ < bytes_.size() && is_blank(bytes_[at_]); ++at_)
            line_ += static_cast<std::size_t>(bytes_[at_] == '\n');
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && !is_blank(bytes_[at_])) ++at_;
        double x = 0;
        const char *first = bytes_.data() + begin, *last = bytes_.data() + at_;
        if (const auto [end, error] = std::from_chars(first, last, x);
            error != std::errc{} || end != last || first == last)
            refuse(begin == bytes_.size()
                       ? "expected more numbers, found the end of the file"
                       : fmt::format("expected a number, found \"{}\"",
                                     bytes_.substr(begin, std::min<std::size_t>(at_ - begin, 40))));
        return x;
    }

    double number(Kind kind) {
        if (encoding_ == Encoding::text) return word();
        switch (kind) {
        case Kind::int8:
            return scalar<std::int8_t>();
        case Kind::uint8:
            return scalar<std::uint8_t>();
        case Kind::int16:
            return scalar<std::int16_t>();
        case Kind::uint16:
            return scalar<std::uint16_t>();
        case Kind::int32:
            return scalar<std::int32_t>();
        case Kind::uint32:
            return scalar<std::uint32_t>();
        case Kind::float32:
            return scalar<float>();
        case Kind::float64:
            break;
        }
        return scalar<double>();
    }

    void read_row(const Element& element, std::size_t row) {
        Vec3 corner = Vec3::Constant(std::nan(""));
        if (mesh_.binary) line_ = row + 1; // for messages
        for (const Property& p : element.properties) {
            if (p.count) {
                const bool is_face = element.name == "face" &&
                                     (p.name == "vertex_indices" || p.name == "vertex_index");
                read_list(p, is_face, row);
                continue;
            }
            const double x = number(p.kind);
            if (element.name == "vertex" && p.name.size() == 1 && p.name >= "x" && p.name <= "z")
                corner[p.name.front() - 'x'] = x;
        }
        if (element.name != "vertex") return;
        if (corner.hasNaN()) refuse("vertex: expected the numbers x, y and z");
        mesh_.corners.push_back(corner);
    }

    void read_list(const Property& p, bool is_face, std::size_t row) {
        const double count = number(*p.count);
        if (!(count >= (is_face ? 3 : 0) && count <= static_cast<double>(bytes_.size()) &&
              count == std::floor(count)))
            refuse(fmt::format("{}: expected {}, found {:g}", p.name,
                               is_face ? "at least three indices" : "the length of a list", count));
        std::vector<std::size_t> polygon;
        for (double k = 0; k < count; ++k) {
            const double index = number(p.kind);
            if (!is_face) continue;
            if (!(index >= 0 && index < static_cast<double>(mesh_.corners.size()) &&
                  index == std::floor(index)))
                refuse(fmt::format("face: expected an index in 0..{}, found {:g}",
                                   static_cast<double>(mesh_.corners.size()) - 1, index));
            polygon.push_back(static_cast<std::size_t>(index));
        }
        if (is_face) mesh_.add_face(polygon, mesh_.binary ? row + 1 : line_);
    }

    std::filesystem::path path_;
    std::string_view bytes_;
    std::size_t at_ = 0, line_ = 0;
    std::optional<Encoding> encoding_;
    std::vector<Element> elements_;
    RawMesh mesh_;
};

} // namespace

Polyhedron read_ply(const std::filesystem::path& path) {
    const std::string bytes = read_whole(path); // may be binary
    return closed_surface(PlyReader(path, without_mark(bytes)).read());
}

} // namespace bris
