#pragma once

#include "engine/io/line_source.hpp"

#include <deque>
#include <optional>
#include <utility>

namespace bris::testing {

/// Lines from memory.
class GivenLines : public Lines {
public:
    explicit GivenLines(std::deque<Line> lines) : lines_(std::move(lines)) {}
    std::optional<Line> next(double) override {
        if (lines_.empty()) return {};
        Line first = std::move(lines_.front());
        lines_.pop_front();
        now_ = first.arrival;
        return first;
    }
    bool over() const override { return lines_.empty(); }
    double now() const override { return now_; }

private:
    std::deque<Line> lines_;
    double now_ = no_arrival;
};

} // namespace bris::testing
