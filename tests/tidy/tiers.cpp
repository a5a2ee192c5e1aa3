#include "tiers.hpp"

#include <algorithm>
#include <map>

namespace busbar::tidy {

namespace {

const std::string readme_path = "include/busbar/README.md";

std::string folder_of(const std::string& header)
{
    return header.substr(0, header.find('/') + 1);
}

bool names(const Tier& tier, const std::string& entry)
{
    return std::find(tier.begin(), tier.end(), entry) != tier.end();
}

} // namespace

std::vector<Tier> read_tiers(const File& readme)
{
    static const std::string item = "- `";
    std::vector<Tier> tiers;
    bool is_within = false;
    for (const std::string& line : readme.lines) {
        if (line.starts_with("#")) {
            is_within = line.starts_with("## Tier");
            if (is_within) {
                tiers.emplace_back();
            }
        } else if (is_within && line.starts_with(item)) {
            tiers.back().push_back(
                line.substr(item.size(), line.find('`', item.size()) - item.size()));
        }
    }
    return tiers;
}

Findings check_tiers(const std::vector<Tier>& tiers, const std::vector<File>& headers)
{
    Findings findings;
    std::map<std::string, std::size_t> uses; // by entry
    for (const Tier& tier : tiers) {
        for (const std::string& entry : tier) {
            if (!uses.emplace(entry, 0).second) {
                findings.push_back(readme_path + ": " + entry + " is there twice");
            }
        }
    }
    for (const File& header : headers) {
        const auto by_name = uses.find(header.path);
        const auto found = by_name != uses.end() ? by_name : uses.find(folder_of(header.path));
        if (found == uses.end()) {
            findings.push_back(header.path + ": is in no tier");
        } else {
            ++found->second;
        }
    }
    for (const auto& [entry, count] : uses) {
        if (count == 0) {
            findings.push_back(readme_path + ": " + entry + " stands for no header");
        }
    }
    return findings;
}

std::size_t lines_of(const Tier& tier, const std::vector<File>& headers)
{
    std::size_t lines = 0;
    for (const File& header : headers) {
        lines += names(tier, header.path) ? header.lines.size() : 0;
    }
    return lines;
}

Findings check_first_programs(const std::vector<File>& programs, const Tier& allowed)
{
    static const std::string include = "#include <busbar/";
    Findings findings;
    for (const File& program : programs) {
        for (const std::string& line : program.lines) {
            if (!line.starts_with(include)) {
                continue;
            }
            const std::string header = line.substr(include.size(), line.find('>') - include.size());
            if (!names(allowed, header) && !names(allowed, folder_of(header))) {
                findings.push_back(program.path + ": includes " + header);
            }
        }
    }
    return findings;
}

} // namespace busbar::tidy
