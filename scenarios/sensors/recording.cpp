#include "scenarios/sensors/recording.hpp"

#include "scenarios/sensors/channels.hpp"

#include <algorithm>

namespace bris {

void reject_flagged(Recording& r) {
    std::vector<char> is_flagged;
    for (const std::uint64_t flags : r.flags) is_flagged.push_back(r.info.leaves_out(flags));
    const auto keep = [&](auto& values) {
        std::size_t kept = 0;
        for (std::size_t k = 0; k < values.size(); ++k)
            if (!is_flagged[k]) values[kept++] = values[k];
        values.resize(kept);
    };
    if (std::ranges::count(is_flagged, 1) > 0) {
        for (std::size_t k = 0; k < r.size(); ++k)
            if (is_flagged[k]) r.flagged.push_back(r.time[k]);
        keep(r.time);
        for (const Channel& channel : all_channels) channel.visit(r, keep);
    }
    for (const Channel& channel : all_channels)
        if (channel.is(Channel::sparse) && channel.without_number(r) == channel.samples(r)) {
            channel.visit(r, [](auto& values) { values.clear(); });
            r.first_without.erase(std::string(channel.names.columns));
        }
}

} // namespace bris
