#pragma once

#include "scenarios/monitoring/sensor_verdict.hpp"

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

namespace bris {

/// Results of passages, one after the other: a line of history.csv for each sensor and revision
/// (verdict, ratios, features in standard deviations, the report's charts), and in memory, which
/// stays bounded, the last passages and those with the most serious result of a sensor. A later
/// revision replaces the one before.
class PassageLog {
public:
    static constexpr std::size_t most_last = 200; ///< passages that are kept in any case

    /// Begins history.csv in a folder anew. Throws OutputError, as `add` does.
    explicit PassageLog(const std::filesystem::path& folder);
    /// Adds a result in place of those with its id or with ids that it `replaces`. What the page
    /// does not show of it and of those before is forgotten.
    void add(PassageResult passage, const std::vector<std::uint64_t>& replaces = {});
    /// In the order in which they were added.
    const std::vector<PassageResult>& kept() const { return kept_; }
    std::size_t count() const { return tally_.all(); }   ///< of all passages
    const PassageTally& tally() const { return tally_; } ///< of all passages

private:
    void write(const PassageResult& passage);

    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::filesystem::path path_;
    std::unique_ptr<std::FILE, Close> file_;
    std::vector<PassageResult> kept_;
    PassageTally tally_;
    std::map<std::uint64_t, Verdict> provisional_; // counted in the tally
};

} // namespace bris
