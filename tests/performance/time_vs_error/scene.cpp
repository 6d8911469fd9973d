#include "tests/performance/time_vs_error/scene.hpp"

#include "engine/archive.hpp"

#include <algorithm>
#include <chrono>

namespace bris::time_vs_error {

Settings Settings::with(const Settings& others) const {
    Settings result = *this;
    for (const auto& [name, value] : others.words_) result.set(name, value);
    return result;
}

std::string Settings::text() const {
    std::string text;
    for (const auto& [name, value] : words_) text += (text.empty() ? "" : " ") + name + "=" + value;
    return text;
}

std::string fingerprint_of(const std::vector<Measured>& measured) {
    std::vector<double> values;
    for (const Measured& m : measured) values.push_back(m.value);
    Archive archive;
    archive.put("measured", std::span<const double>(values));
    return hexadecimal(fingerprint(archive));
}

double median_time(unsigned rounds, double longest, const std::function<void()>& call) {
    std::vector<double> times;
    double sum = 0;
    while (times.size() < rounds && (times.empty() || sum < longest)) {
        const auto began = std::chrono::steady_clock::now();
        call();
        times.push_back(
            std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
        sum += times.back();
    }
    std::sort(times.begin(), times.end());
    return 0.5 * (times[(times.size() - 1) / 2] + times[times.size() / 2]);
}

} // namespace bris::time_vs_error
