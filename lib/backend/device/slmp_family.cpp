#include "slmp_family.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/backend/slmp_end_code.hpp>

namespace busbar::backend {

namespace {

/// In the order of SlmpFamily.
constexpr std::array<const char*, 5> family_names{"auto", "iq-r", "q", "q-module", "fx5"};

/// The family of a type's name: "R08CPU", "L16HCPU" (iQ-L), "Q03UDECPU", "L02CPU", "FX5U-32MT/DS".
/// Auto if it is none of these. A port that refuses to tell the name is a built-in one of Q or L.
SlmpFamily family_of(std::string_view name, std::uint16_t end_code)
{
    if (end_code != 0) {
        return slmp_end_code(end_code).fault == SlmpFault::Request ? SlmpFamily::Q
                                                                   : SlmpFamily::Auto;
    }
    if (name.starts_with("FX5")) {
        return SlmpFamily::Fx5;
    }
    if (name.size() < 3 || name[1] < '0' || name[1] > '9') {
        return SlmpFamily::Auto;
    }
    const bool is_iq_l = name[0] == 'L' && name.substr(1, 3).find('H') != std::string_view::npos;
    if (name[0] == 'R' || is_iq_l) {
        return SlmpFamily::IqR;
    }
    return name[0] == 'Q' || name[0] == 'L' ? SlmpFamily::QModule : SlmpFamily::Auto;
}

} // namespace

const char* name_of(SlmpFamily family)
{
    return family_names[static_cast<std::size_t>(family)];
}

std::optional<SlmpFamily> find_slmp_family(std::string_view name)
{
    const auto* const found = std::ranges::find(family_names, name);
    return found == family_names.end()
               ? std::nullopt
               : std::optional{static_cast<SlmpFamily>(found - family_names.begin())};
}

SlmpProtocolOptions slmp_options(SlmpFamily family)
{
    SlmpProtocolOptions options;
    options.family = family;
    const bool is_q = family == SlmpFamily::Q || family == SlmpFamily::QModule;
    options.notation.has_long_form = !is_q && family != SlmpFamily::Fx5;
    if (family == SlmpFamily::Fx5) {
        options.notation.is_octal = true;
        options.client.frame = SlmpFrame::Frame3E;
        options.client.timer = 0; // the manual wants it
    }
    return options;
}

namespace detail {

std::string SlmpFindings::learn(std::string_view type_name, std::uint16_t end_code)
{
    const SlmpFamily found = family_of(type_name, end_code);
    const bool is_octal = configured == SlmpFamily::Fx5;
    const bool is_told = found != SlmpFamily::Auto && end_code == 0;
    if (has_io && configured != SlmpFamily::Auto && is_told &&
        (found == SlmpFamily::Fx5) != is_octal) {
        return "it is another family than configured, in which X and Y are " +
               std::string{is_octal ? "hexadecimal" : "octal"} + ": set family = \"" +
               name_of(found) + "\"";
    }
    if (std::exchange(name, type_name) == type_name && version > 0) {
        return {};
    }
    family = found == SlmpFamily::Auto ? configured : found;
    has_random_read = has_random_write = true;
    has_block_read = has_block_write = family != SlmpFamily::Q;
    has_long_form = slmp_options(family).notation.has_long_form;
    ++version;
    return {};
}

void SlmpFindings::set_long_form(bool has_it)
{
    version += std::exchange(has_long_form, has_it) != has_it ? 1U : 0U;
}

bool SlmpFindings::lose(SlmpCommand command)
{
    bool* const has = command == SlmpCommand::RandomRead    ? &has_random_read
                      : command == SlmpCommand::RandomWrite ? &has_random_write
                      : command == SlmpCommand::BlockRead   ? &has_block_read
                                                            : &has_block_write;
    version += *has ? 1U : 0U;
    return std::exchange(*has, false);
}

SlmpLimits limits_of(const SlmpFindings& findings, bool is_datagram)
{
    const bool is_long = findings.has_long_form;
    SlmpLimits limits;
    if (findings.family == SlmpFamily::Fx5 || findings.family == SlmpFamily::Auto) {
        limits.bits = 3'584;
    }
    if (findings.family == SlmpFamily::Fx5 && !is_datagram) {
        limits.under_way = 1;
    }
    if (findings.has_random_read) {
        limits.random_read = is_long ? 96 : 192;
        limits.random_read_extended = is_long ? 96 : 185; // as a QJ71E71 was measured to take
    }
    if (findings.has_random_write) {
        // A word counts 12 of 960 or 1,920 bytes.
        limits.random_write = is_long ? 80 : 160;
        limits.random_write_bits = is_long ? 94 : 188;
    }
    // Blocks of words and of bits together (MELSEC Communication Protocol Reference Manual,
    // Appendix 5). A PLC that takes fewer refuses a request by its size, which is then divided.
    if (findings.has_block_read) {
        limits.read_blocks = is_long ? 60 : 120;
    }
    if (findings.has_block_write) {
        limits.write_blocks = is_long ? 60 : 120;
    }
    return limits;
}

SlmpFindings findings_of(const SlmpProtocolOptions& options)
{
    SlmpFindings findings;
    findings.frame = options.client.frame;
    findings.may_change = options.finds_frame;
    findings.has_long_form = options.notation.has_long_form;
    findings.configured = findings.family = options.family;
    findings.has_block_read = findings.has_block_write = options.family != SlmpFamily::Q;
    return findings;
}

} // namespace detail

} // namespace busbar::backend
