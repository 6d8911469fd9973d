#pragma once

#include "engine/entity.hpp"
#include "engine/ordering.hpp"
#include "engine/ranks.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace bris {

/// Brings what the ranks of a divided world have of some rows to the first one, in the order of the
/// ids, of which no two ranks have the same. All ranks must make it and gather the same values. In
/// a world that is not divided the rows of this process are brought into that order.
class RowsOfRanks {
public:
    /// `ids`: of this rank's rows; then of those of all on the first one, and none elsewhere.
    template <class Id>
    RowsOfRanks(std::vector<Id>& ids, bool is_divided) : is_divided_(is_divided) {
        if (is_divided_) Ranks::gather(ids);
        order_ = all_rows(ids.size());
        is_in_order_ = std::ranges::is_sorted(ids);
        if (is_in_order_) return;
        std::ranges::stable_sort(order_, {}, [&](Row k) { return ids[k]; });
        std::ranges::sort(ids);
    }
    std::size_t size() const { return order_.size(); }

    /// Does the same with values of which each row has as many.
    template <class T>
    void gather(std::vector<T>& values) const {
        if (is_divided_) {
            wait_for_writer();
            Ranks::gather(values);
        }
        if (is_in_order_) return;
        const std::size_t each = values.size() / size();
        const auto before = values;
        for (std::size_t k = 0; k < size(); ++k)
            std::copy_n(&before[order_[k] * each], each, &values[k * each]);
    }
    /// The first rank may have written what it got to a slow disk. To be called before a message
    /// that is not gathered here.
    void wait_for_writer() const {
        if (!is_divided_) return;
        (void)Ranks::writes();
        Ranks::meet();
    }

private:
    bool is_divided_, is_in_order_ = true;
    std::vector<Row> order_; // of the rows as they come
};

} // namespace bris
