#include "systems/fusion/analysis_record.hpp"

#include "engine/io/csv.hpp"

#include <string>

namespace bris {

void save_records(Archive& archive, const std::string& path,
                  const std::vector<AnalysisRecord>& records) {
    std::vector<double> numbers;
    for (const AnalysisRecord& r : records)
        AnalysisRecord::visit(r, [&](const char*, double number) { numbers.push_back(number); });
    archive.put(path, std::span<const double>(numbers));
}

std::vector<AnalysisRecord> load_records(const Archive& archive, const std::string& path) {
    const auto numbers = archive.get<double>(path);
    std::vector<AnalysisRecord> records;
    for (auto next = numbers.begin(); next != numbers.end();)
        AnalysisRecord::visit(records.emplace_back(),
                              [&](const char*, double& number) { number = *next++; });
    return records;
}

void write_records(const std::filesystem::path& csv, const std::vector<AnalysisRecord>& records,
                   const std::string& time) {
    std::vector<std::string> names;
    const AnalysisRecord any;
    AnalysisRecord::visit(any, [&](const char* name, double) { names.emplace_back(name); });
    names.front() = time;
    std::vector<std::vector<double>> rows;
    for (AnalysisRecord r : records) {
        ++r.sensor; // numbered from 1, as the sensor files are
        rows.emplace_back();
        AnalysisRecord::visit(r,
                              [&](const char*, double number) { rows.back().push_back(number); });
    }
    write_csv(csv, names, rows, {}, 6);
}

} // namespace bris
