#include "scenarios/records/logged_axes.hpp"

#include "engine/errors.hpp"
#include "scenarios/sensors/axis_titles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace bris {

namespace {

/// Whether the name of the file says that it is of a gyroscope.
bool is_of_gyroscope(const std::filesystem::path& file) {
    std::string name = file.stem().string();
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return name.find("gyro") != std::string::npos;
}

class VectorFinder {
public:
    VectorFinder(const LoggerTable& table, const std::vector<SampledColumn>& sample,
                 const std::vector<GivenColumn>& given, std::vector<char>& is_taken,
                 std::vector<std::string>& notes)
        : table_(table), sample_(sample), given_(given), is_taken_(is_taken), notes_(notes) {}

    std::vector<LoggedVector> find() {
        for (const bool is_rate : {false, true}) take_given(is_rate);
        const bool has_force = has(false), has_rate = has(true);
        if (!has_force && table_.titles.empty()) take_by_contents(has_rate);
        const auto titled = vectors_in_titles();
        if (!has_force) take_forces(titled);
        if (!has_rate) take_rates(titled);
        require(!found_.empty(),
                fmt::format("{}: expected columns of accelerations such as \"ax [g]\", found {}; "
                            "add --axes \"ax=2, ay=3, az=4\" with the numbers of yours",
                            table_.path.string(), table_.columns()));
        return std::move(found_);
    }

private:
    bool has(bool is_rate) const {
        return std::ranges::any_of(found_, [&](const auto& v) { return v.is_rate == is_rate; });
    }

    void take_given(bool is_rate) {
        LoggedVector vector{.is_rate = is_rate};
        bool is_given = false;
        for (const GivenColumn& column : given_) {
            const auto axis = std::string_view("xyz").find(column.ours.back());
            if (column.ours.size() != 2 || column.ours[0] != (is_rate ? 'g' : 'a')) continue;
            is_given = true;
            vector.axes[axis] = {column.index, column.sign,
                                 column.unit.empty() ? unit_of(column.index) : column.unit,
                                 !column.unit.empty()};
        }
        if (is_given) found_.push_back(vector); // the caller has marked them as taken
    }

    std::string unit_of(std::size_t c) const {
        if (!table_.titles.empty())
            if (const auto title = axis_title(table_.titles[c]); title && !title->unit_word.empty())
                return title->unit_word;
        return c < table_.units_below.size() ? table_.units_below[c] : "";
    }

    void take(const LoggedVector& vector) {
        for (const auto& axis : vector.axes)
            if (axis) is_taken_[axis->index] = 1;
        found_.push_back(vector);
    }

    /// Three columns of numbers are ax ay az, six gx gy gz besides.
    void take_by_contents(bool has_rate) {
        std::vector<std::size_t> free;
        for (std::size_t c = 0; c < sample_.size(); ++c)
            if (!is_taken_[c] && sample_[c].has_numbers()) free.push_back(c);
        const bool is_clear = free.size() == 1 || free.size() == 3 || free.size() == 6;
        require(is_clear,
                fmt::format("{}: expected names of the columns, or one, three or six of them "
                            "besides times and sensors, found {}, of which {} are left; add --axes "
                            "\"ax=2, ay=3, az=4\" with the numbers of yours",
                            table_.path.string(), table_.columns(), free.size()));
        LoggedVector force, rate{.is_rate = true};
        for (std::size_t k = 0; k < free.size(); ++k)
            (k < 3 ? force : rate).axes[free.size() == 1 ? 2 : k % 3] = {.index = free[k]};
        notes_.push_back(fmt::format("The columns have no names; from {} on they are taken as {}.",
                                     table_.described(free.front()),
                                     free.size() == 1   ? "az"
                                     : free.size() == 3 ? "ax ay az"
                                                        : "ax ay az gx gy gz"));
        take(force);
        if (free.size() == 6 && !has_rate) take(rate);
    }

    /// The vectors that titles name; the first column counts for an axis.
    std::vector<LoggedVector> vectors_in_titles() const {
        std::vector<LoggedVector> all;
        for (std::size_t c = 0; c < table_.titles.size(); ++c) {
            if (is_taken_[c] || !sample_[c].has_numbers()) continue;
            const auto title = axis_title(table_.titles[c]);
            if (!title) continue;
            const bool is_rate = title->is_rate || (title->is_bare && is_of_gyroscope(table_.path));
            auto vector = std::ranges::find_if(all, [&](const LoggedVector& v) {
                return v.number == title->number && v.is_rate == is_rate &&
                       v.is_linear == title->is_linear && v.is_bare == title->is_bare;
            });
            if (vector == all.end())
                vector = all.insert(all.end(), {.number = title->number,
                                                .is_rate = is_rate,
                                                .is_linear = title->is_linear,
                                                .is_bare = title->is_bare});
            auto& axis = vector->axes[title->axis];
            if (!axis) axis = {.index = c, .unit_word = unit_of(c)};
        }
        return all;
    }

    /// Those that contain gravity or, if there are none, those from which it has been removed.
    void take_forces(const std::vector<LoggedVector>& titled) {
        const auto is_force = [](const LoggedVector& v, bool is_linear, bool is_bare) {
            return !v.is_rate && v.is_linear == is_linear && v.is_bare == is_bare;
        };
        for (const auto& [is_linear, is_bare] :
             {std::pair{false, false}, {true, false}, {false, true}}) {
            if (has(false)) continue;
            for (const LoggedVector& v : titled)
                if (is_force(v, is_linear, is_bare)) take(v);
        }
    }

    void take_rates(const std::vector<LoggedVector>& titled) {
        for (const bool is_bare : {false, true}) {
            if (has(true)) continue;
            for (const LoggedVector& v : titled)
                if (v.is_rate && v.is_bare == is_bare) take(v);
        }
    }

    const LoggerTable& table_;
    const std::vector<SampledColumn>& sample_;
    const std::vector<GivenColumn>& given_;
    std::vector<char>& is_taken_;
    std::vector<std::string>& notes_;
    std::vector<LoggedVector> found_;
};

} // namespace

std::vector<LoggedVector> find_logged_vectors(const LoggerTable& table,
                                              const std::vector<SampledColumn>& sample,
                                              const std::vector<GivenColumn>& given,
                                              std::vector<char>& is_taken,
                                              std::vector<std::string>& notes) {
    return VectorFinder(table, sample, given, is_taken, notes).find();
}

} // namespace bris
