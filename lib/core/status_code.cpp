#include <busbar/core/status_code.hpp>

namespace busbar {

namespace {

struct Row {
    std::uint32_t value;
    std::string_view name;
};

constexpr Row rows[] = {
#include <busbar/core/status_names.inc>
};

} // namespace

std::string_view name(StatusCode code)
{
    const std::uint32_t wanted = code.code().value();
    for (const Row& row : rows) {
        if (row.value == wanted) {
            return row.name;
        }
    }
    return {};
}

} // namespace busbar
