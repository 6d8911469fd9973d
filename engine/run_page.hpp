#pragma once

#include "engine/report.hpp"
#include "engine/scenario.hpp"

namespace bris {

class HtmlPage;

/// Writes report.html into the folder of the results: one page that needs no other file and no
/// network, with what the report shows, the pictures that this run has drawn, how it was made, and
/// its files. Called when all other files are written. Only the first rank of a run writes. Throws
/// OutputError.
void write_run_page(const Common& common, const Report& results);

/// Adds to a page which settings of the run differ from the defaults, how to make it again, and
/// the versions.
void add_origin(HtmlPage& page, const Common& common);

} // namespace bris
