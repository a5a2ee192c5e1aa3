#include "describe.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/published_program.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/server/process_image.hpp>
#include <busbar/server/worst_case_memory.hpp>

#include "product/configuration/limit_keys.hpp"
#include "product/configuration/sections.hpp"
#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

using server::LimitUnit;
using server::MemoryRow;

using Line = std::array<std::string, 5>;

std::string value_text(const MemoryRow& row)
{
    switch (row.unit) {
    case LimitUnit::Bytes:
        return std::to_string(row.value) + " B";
    case LimitUnit::Milliseconds:
        return std::to_string(row.value) + " ms";
    case LimitUnit::Count:
        break;
    }
    return std::to_string(row.value);
}

std::vector<Line> lines_of(const server::WorstCaseMemory& all)
{
    std::vector<Line> lines{{"limit", "value", "key in [limits]", "memory", "what is held"}};
    std::string_view last;
    for (const MemoryRow& row : all.rows) {
        const bool is_same = row.limit == last;
        last = row.limit;
        const std::string memory = row.count != 0 ? size_text(row.bytes()) : std::string{};
        lines.push_back({is_same ? std::string{} : std::string{row.limit},
                         is_same ? std::string{} : value_text(row),
                         is_same ? std::string{} : key_of(row.limit), memory,
                         std::string{row.held}});
    }
    lines.push_back({"in all, at worst", "", "", size_text(all.total()), ""});
    return lines;
}

/// The image of the machine's program; an empty one without a program, since the PLC's has no
/// structures.
std::shared_ptr<const server::ProcessImage> image_of(const ControllerConfig& config)
{
    if (!config.machine.program) {
        return server::ProcessImage::create({}, config.image);
    }
    const auto program =
        controller::PublishedProgram::create(config.machine.program, config.machine.publishing);
    return expect(program->make_image(
                      1, {.image = config.image, .elementary = config.machine.types.elementary}))
        .image();
}

/// Aligns numbers to the right and texts to the left, without trailing blanks.
std::string in_columns(const std::vector<Line>& lines)
{
    std::array<std::size_t, 5> widths{};
    for (const Line& line : lines) {
        for (std::size_t i = 0; i < line.size(); ++i) {
            widths[i] = std::max(widths[i], line[i].size());
        }
    }
    std::string text;
    for (const Line& line : lines) {
        std::string out;
        for (std::size_t i = 0; i < line.size(); ++i) {
            const std::string space(widths[i] - line[i].size(), ' ');
            const bool is_number = i == 1 || i == 3;
            out += (i == 0 ? "" : "  ") + (is_number ? space + line[i] : line[i] + space);
        }
        out.erase(out.find_last_not_of(' ') + 1);
        text += out + "\n";
    }
    return text;
}

/// Writes a number as "65,535".
std::string with_commas(std::uint64_t number)
{
    std::string text = std::to_string(number);
    for (std::size_t at = text.size(); at > 3;) {
        at -= 3;
        text.insert(at, ",");
    }
    return text;
}

} // namespace

std::string describe_limits(const ControllerConfig& config)
{
    return in_columns(lines_of(worst_case_of(config, *image_of(config))));
}

int print_limits(const std::string& file)
{
    ControllerConfig config = read_config_or_default(file);
    if (file.empty()) { // the first start creates an account
        config.users.accounts.emplace_back();
    }
    std::fputs(describe_limits(config).c_str(), stdout);
    return 0;
}

std::string describe_capacities(const ControllerConfig& config)
{
    std::string text = "| at most | | key in `[limits]` |\n|---|---|---|\n";
    for (const LimitKey* const key : limits_in(&LimitKey::capacity)) {
        const auto value = static_cast<std::uint64_t>(key->get(config));
        text += "| " + std::string{key->capacity.name} + " | " +
                (key->unit == "B" ? size_text(value) : with_commas(value)) + " | `" +
                key_of(key->cost) + "` |\n";
    }
    return text;
}

int print_capacities(const std::string& file)
{
    std::fputs(describe_capacities(read_config_or_default(file)).c_str(), stdout);
    return 0;
}

} // namespace busbar::product
