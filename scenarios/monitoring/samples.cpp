#include "scenarios/monitoring/samples.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace bris {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t bit(std::size_t column) { return std::uint64_t{1} << column; }

} // namespace

std::vector<std::string_view> monitored_fields() {
    std::vector<std::string_view> fields{"t", "id", "end"};
    for (const Channel& channel : all_channels)
        for (std::size_t k = 0; !channel.is(Channel::unmonitored) && k < channel.size(); ++k)
            fields.push_back(channel.column(k));
    return fields;
}

double Samples::number(std::size_t row, std::size_t name) const {
    return column_[name] < 0 ? nan
                             : numbers_[row * stride_ + static_cast<std::size_t>(column_[name])];
}

/// Makes room for more columns in all rows.
void Samples::widen(std::uint64_t wanted) {
    const auto before = column_;
    const std::size_t old_stride = stride_;
    has_ |= wanted;
    stride_ = 0;
    for (std::size_t c = 0; c < columns; ++c)
        column_[c] = (has_ >> c & 1) != 0 ? static_cast<std::int8_t>(stride_++) : std::int8_t{-1};
    std::vector<double> wider(size() * stride_, nan);
    for (std::size_t row = 0; row < size(); ++row)
        for (std::size_t c = 0; c < columns; ++c)
            if (old_stride > 0 && before[c] >= 0)
                wider[row * stride_ + static_cast<std::size_t>(column_[c])] =
                    numbers_[row * old_stride + static_cast<std::size_t>(before[c])];
    numbers_ = std::move(wider);
}

/// For one more row, without setting aside as much again, as vectors do.
void Samples::make_room() {
    const std::size_t rows = size();
    if (numbers_.size() + stride_ > numbers_.capacity())
        numbers_.reserve((rows + rows / 8 + 256) * stride_);
    if (rows == states_.capacity()) states_.reserve(rows + rows / 8 + 256);
}

void Samples::add(const GatedRecord& record) {
    std::uint64_t sent = 1;
    if (record.count >= 0) sent |= bit(count);
    for (const Channel& channel : all_channels) {
        const std::size_t first = 1 + channel.place;
        if (channel.is(Channel::unmonitored) || first == count) continue;
        for (std::size_t k = 0; k < channel.size(); ++k) // vectors have all parts
            if (record.record.has(first_channel_field + channel.place + k))
                sent |= bit(first + channel.size()) - bit(first);
    }
    if (stride_ == 0 || (sent & ~has_) != 0) widen(sent);
    is_sorted_ = is_sorted_ && (empty() || record.t > time(size() - 1));
    make_room();
    const std::size_t begin = numbers_.size();
    numbers_.resize(begin + stride_, nan);
    numbers_[begin] = record.t;
    for (std::size_t c = 1; c < columns; ++c)
        if (column_[c] >= 0 && c != count)
            numbers_[begin + static_cast<std::size_t>(column_[c])] =
                record.record.number(first_channel_field + c - 1);
    if (record.count >= 0)
        numbers_[begin + static_cast<std::size_t>(column_[count])] =
            static_cast<double>(record.count);
    states_.push_back(State::unknown);
}

std::size_t Samples::sort() {
    if (is_sorted_) return 0;
    std::vector<std::size_t> order(size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t row) { return time(row); });
    std::vector<double> numbers;
    std::vector<State> states;
    numbers.reserve(numbers_.size());
    states.reserve(size());
    std::size_t twice = 0;
    for (const std::size_t row : order) {
        if (!states.empty() && numbers[(states.size() - 1) * stride_] == time(row)) {
            ++twice;
            continue;
        }
        const auto from = numbers_.begin() + static_cast<std::ptrdiff_t>(row * stride_);
        numbers.insert(numbers.end(), from, from + static_cast<std::ptrdiff_t>(stride_));
        states.push_back(states_[row]);
    }
    numbers_ = std::move(numbers);
    states_ = std::move(states);
    is_sorted_ = true;
    return twice;
}

Samples Samples::extract(std::size_t begin, std::size_t end) {
    const auto row = [&](std::size_t k) {
        return numbers_.begin() + static_cast<std::ptrdiff_t>(k * stride_);
    };
    const auto state = [&](std::size_t k) {
        return states_.begin() + static_cast<std::ptrdiff_t>(k);
    };
    Samples part;
    part.has_ = has_;
    part.column_ = column_;
    part.stride_ = stride_;
    part.numbers_.assign(row(begin), row(end));
    part.states_.assign(state(begin), state(end));
    numbers_.erase(row(begin), row(end));
    states_.erase(state(begin), state(end));
    if (numbers_.capacity() > 2 * numbers_.size()) {
        numbers_.shrink_to_fit();
        states_.shrink_to_fit();
    }
    return part;
}

void Samples::merge(Samples other) {
    if (other.empty()) return;
    if (empty()) {
        *this = std::move(other);
        return;
    }
    if (stride_ == 0 || (other.has_ & ~has_) != 0) widen(other.has_);
    for (std::size_t k = 0; k < other.size(); ++k) {
        make_room();
        for (std::size_t c = 0; c < columns; ++c)
            if (column_[c] >= 0) numbers_.push_back(other.number(k, c));
        states_.push_back(other.state(k));
    }
    is_sorted_ = false;
}

std::size_t Samples::row_at(double t) const {
    std::size_t low = 0, high = size();
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (time(middle) < t)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

Recording Samples::recording(const SensorInfo& info) const {
    Recording r;
    r.info = info;
    const auto has = [&](std::size_t name) { return column_[name] >= 0; };
    bool counted = has(count);
    for (std::size_t k = 0; k < size(); ++k) counted = counted && number(k, count) >= 0;
    std::vector<const Channel*> measured;
    for (const Channel& channel : all_channels)
        if (!channel.is_count() && has(1 + channel.place)) measured.push_back(&channel);
    r.time.reserve(size());
    if (counted) r.sequence.reserve(size());
    for (const Channel* channel : measured)
        channel->visit(r, [&](auto& values) { values.reserve(size()); });
    for (std::size_t k = 0; k < size(); ++k) {
        r.time.push_back(time(k));
        if (counted) r.sequence.push_back(static_cast<std::uint64_t>(number(k, count)));
        for (const Channel* channel : measured) // components are next to each other
            channel->append(
                r, &numbers_[k * stride_ + static_cast<std::size_t>(column_[1 + channel->place])]);
        if (has(flags)) {
            const double bits = number(k, flags);
            r.flags.push_back(std::isnan(bits) ? 0
                              : is_count(bits) ? static_cast<std::uint64_t>(bits)
                                               : 1);
        }
    }
    reject_flagged(r);
    return r;
}

} // namespace bris
