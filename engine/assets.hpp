#pragma once

#include <filesystem>
#include <string>

namespace bris {

/// Folder of the data files that come with the code: clumps, gradings, example recordings. The
/// first of: the folder given by --assets, `assets` beside the program (in a build folder a link
/// to that of the source), and `../share/bris/assets` seen from there. If none exists, the second
/// one, so that the message about the first file that is missing names it.
std::filesystem::path assets_folder();

/// Finds `--assets FOLDER` or `--assets=FOLDER` on a command line. To be called once, before
/// anything asks for the folder, because defaults of options depend on it. Throws InputError unless
/// it is a folder.
void find_assets(int argc, char** argv);

/// The file that an option names: `name` + `ending` in the folder `kind` of the assets, or else the
/// path of a file. Throws InputError that names the option and lists the files in the assets.
std::filesystem::path asset_or_file(const std::string& option, const std::string& kind,
                                    const std::string& name, const std::string& ending);

} // namespace bris
