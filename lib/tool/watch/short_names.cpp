#include "model.hpp"

#include <algorithm>
#include <set>

namespace busbar::tool::watch {

namespace {

bool is_digit(char character)
{
    return character >= '0' && character <= '9';
}

/// A path of browse names; a NodeId has a =, and one in brackets begins a path from that node.
bool is_path(const std::string& name)
{
    return name.find('=') == std::string::npos && !name.starts_with('[');
}

/// "/Objects/2:Press/Speed" without the numbers; "&" keeps what follows it from being one.
std::string without_namespaces(const std::string& path)
{
    std::string plain;
    for (std::size_t at = 0; at < path.size();) {
        std::size_t end = at;
        while (end < path.size() && is_digit(path[end])) {
            ++end;
        }
        if (end > at && end < path.size() && path[end] == ':') {
            at = end + 1;
        }
        end = at;
        while (end < path.size() && path[end] != '/') {
            end += path[end] == '&' ? 2U : 1U;
        }
        end = std::min(end + 1, path.size());
        plain += path.substr(at, end - at);
        at = end;
    }
    return plain;
}

/// Returns the size of the folders that all names begin with.
std::size_t common_folder(const std::vector<std::string>& names)
{
    const std::string& first = names.front();
    std::size_t size = first.size();
    for (const std::string& name : names) {
        const auto [end, other] =
            std::mismatch(first.begin(), first.end(), name.begin(), name.end());
        size = std::min(size, static_cast<std::size_t>(end - first.begin()));
    }
    const std::size_t slash = size == 0 ? std::string::npos : first.rfind('/', size - 1);
    const bool is_escaped = slash != std::string::npos && slash > 0 && first[slash - 1] == '&';
    return slash == std::string::npos || is_escaped ? 0 : slash + 1;
}

} // namespace

ShortNames short_names(const std::vector<std::string>& names)
{
    ShortNames result{names, ""};
    if (names.empty() || !std::all_of(names.begin(), names.end(), is_path)) {
        return result;
    }
    std::transform(names.begin(), names.end(), result.names.begin(), without_namespaces);
    if (std::set<std::string>{result.names.begin(), result.names.end()}.size() !=
        std::set<std::string>{names.begin(), names.end()}.size()) {
        result.names = names;
    }
    const std::size_t size = names.size() < 2 ? 0 : common_folder(result.names);
    if (size > 1) {
        result.folder = result.names.front().substr(0, size - 1);
        for (std::string& name : result.names) {
            name.erase(0, size);
        }
    }
    return result;
}

} // namespace busbar::tool::watch
