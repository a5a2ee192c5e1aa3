#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace busbar::tool {

struct Options;

/// The options of one server by their names, as a file of profiles has them.
using Profile = std::map<std::string, std::vector<std::string>>;

/// Returns the path of the file of profiles: busbar/profiles.toml below XDG_CONFIG_HOME or
/// ~/.config. Empty if neither is set.
[[nodiscard]] std::string profiles_file();
/// Returns the profiles in a text by their names; `file` is for messages. Throws Failure for a key
/// that is not an option of a connection, and for a password, which must be in a separate file.
[[nodiscard]] std::map<std::string, Profile> parse_profiles(const std::string& text,
                                                            const std::string& file);
/// The names in profiles_file(); none if there is no such file or it is wrong.
[[nodiscard]] std::vector<std::string> profile_names();

/// Options that were given on the command line, which count before those of a profile.
[[nodiscard]] std::set<std::string> given_options(const CLI::App& app);
/// Puts the profile of that name into the options that were not given. Throws Failure if there is
/// none.
void apply_profile(const std::string& name, Options& options);
/// Adds what the command line did not say: the profile of --profile or BUSBAR_PROFILE, then the URL
/// of BUSBAR_URL or the usual one. Throws Failure.
void complete_options(Options& options);

} // namespace busbar::tool
