#include "return_diagnostics.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/text.hpp>

namespace busbar::server::detail {

namespace {

constexpr std::string_view opc_ua = "http://opcfoundation.org/UA/";

/// Returns "Bad_NodeIdUnknown" as words: "Node Id Unknown".
std::string words_of(std::string_view name)
{
    const std::size_t bar = name.find('_');
    const std::string_view from = bar == std::string_view::npos ? name : name.substr(bar + 1);
    const auto is_upper = [](char c) { return c >= 'A' && c <= 'Z'; };
    std::string words;
    for (std::size_t i = 0; i < from.size(); ++i) {
        const bool begins_word = i != 0 && is_upper(from[i]) && !is_upper(from[i - 1]);
        words += begins_word ? " " : "";
        words += from[i];
    }
    return words;
}

std::string explained(const std::string& operand, std::string_view reason)
{
    constexpr std::size_t cut = 3; // "..." of printable()
    std::string text = printable(operand, ReturnDiagnostics::max_operand - cut);
    if (!text.empty() && !reason.empty()) {
        text += ": ";
    }
    return text + printable(reason, ReturnDiagnostics::max_reason - cut);
}

} // namespace

std::int32_t ReturnDiagnostics::index_of(std::string_view text)
{
    const auto found = std::find(table_.begin(), table_.end(), text);
    const auto index = static_cast<std::int32_t>(found - table_.begin());
    if (found == table_.end()) {
        table_.emplace_back(text);
    }
    return index;
}

/// `bits` are those of a service.
DiagnosticInfo ReturnDiagnostics::describe(StatusCode status, std::uint32_t bits)
{
    DiagnosticInfo info;
    if ((bits & diagnostic_bit::symbolic_id) != 0) {
        info.namespace_uri = index_of(opc_ua);
        info.symbolic_id = index_of(name(status));
    }
    if ((bits & diagnostic_bit::localized_text) != 0) {
        info.locale = index_of("en");
        info.localized_text = index_of(words_of(name(status)));
    }
    return info;
}

DiagnosticInfo ReturnDiagnostics::of_service(StatusCode status)
{
    return status.is_good() ? DiagnosticInfo{}
                            : describe(status, wanted_ & diagnostic_bit::of_service);
}

DiagnosticInfo ReturnDiagnostics::of_operation(StatusCode status,
                                               FunctionRef<std::string()> operand,
                                               FunctionRef<std::string_view()> reason)
{
    if (status.is_good()) {
        return {};
    }
    const std::uint32_t bits = wanted_ >> diagnostic_bit::to_operations;
    DiagnosticInfo info = describe(status, bits);
    if ((bits & diagnostic_bit::additional_info) != 0 && info_left_ >= max_operand + max_reason) {
        const std::string text = explained(operand(), reason());
        if (!text.empty()) {
            info_left_ -= std::min(text.size(), info_left_);
            info.additional_info = String{text};
        }
    }
    return info;
}

Array<DiagnosticInfo>
ReturnDiagnostics::of_operations(std::size_t count, FunctionRef<StatusCode(std::size_t)> status,
                                 FunctionRef<std::string(std::size_t)> operand,
                                 FunctionRef<std::string_view(std::size_t)> reason)
{
    Array<DiagnosticInfo> all;
    if (!wants_operations()) {
        return all;
    }
    std::size_t i = 0;
    while (i < count && status(i).is_good()) {
        ++i;
    }
    if (i == count) {
        return all;
    }
    all.resize(count);
    for (; i < count; ++i) {
        all[i] = of_operation(
            status(i), [&] { return operand(i); }, [&] { return reason(i); });
    }
    return all;
}

Array<String> ReturnDiagnostics::string_table() const
{
    Array<String> texts;
    for (const std::string& text : table_) {
        texts.emplace_back(text);
    }
    return texts;
}

} // namespace busbar::server::detail
