#include "failure.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <busbar/core/status_codes.hpp>
#include <busbar/core/text.hpp>

#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"

namespace busbar::tool {

namespace {

constexpr std::array not_connected{
    status::Bad_Timeout,
    status::Bad_ConnectionClosed,
    status::Bad_CommunicationError,
    status::Bad_ServerNotConnected,
    status::Bad_NoCommunication,
    status::Bad_NotConnected,
    status::Bad_SecureChannelClosed,
    status::Bad_SecureChannelIdInvalid,
    status::Bad_TcpEndpointUrlInvalid,
    status::Bad_TcpServerTooBusy,
    status::Bad_TcpMessageTypeInvalid,
    status::Bad_TcpInternalError,
    status::Bad_ServerHalted,
    status::Bad_Shutdown,
    status::Bad_SessionClosed,
    status::Bad_ConnectionRejected,
    status::Bad_Disconnect,
    status::Bad_ProtocolVersionUnsupported,
};
constexpr std::array refused{
    status::Bad_SecurityChecksFailed,       status::Bad_SecurityPolicyRejected,
    status::Bad_SecurityModeRejected,       status::Bad_SecurityModeInsufficient,
    status::Bad_IdentityTokenInvalid,       status::Bad_IdentityTokenRejected,
    status::Bad_UserSignatureInvalid,       status::Bad_ApplicationSignatureInvalid,
    status::Bad_NoValidCertificates,        status::Bad_UserAccessDenied,
    status::Bad_IdentityChangeNotSupported,
};

/// All codes that concern certificates have such a name.
bool is_about_certificate(StatusCode code)
{
    return name(code).starts_with("Bad_Certificate");
}

constexpr std::size_t max_shown_candidates = 10;

/// Quotes a text so that a POSIX shell takes it as one word, whatever the server put in it.
std::string shell_word(const std::string& text)
{
    static constexpr std::string_view plain = "/:._=-";
    const auto is_plain = [](char c) {
        const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        return is_letter || (c >= '0' && c <= '9') || plain.find(c) != std::string_view::npos;
    };
    if (std::all_of(text.begin(), text.end(), is_plain)) {
        return text;
    }
    std::string word = "'";
    for (const char c : text) {
        word += c == '\'' ? "'\\''" : std::string{c};
    }
    return word + "'";
}

std::string status_text(StatusCode code)
{
    const std::string_view known = name(code);
    char number[16];
    std::snprintf(number, sizeof number, "0x%08X", code.value());
    return known.empty() ? std::string{number} : std::string{known};
}

} // namespace

Exit exit_of(StatusCode code)
{
    const auto is_in = [code](const auto& list) {
        return std::find(list.begin(), list.end(), code.code()) != list.end();
    };
    if (is_in(refused) || is_about_certificate(code)) {
        return Exit::Refused;
    }
    return is_in(not_connected) ? Exit::NotConnected : Exit::Failed;
}

Failure::Failure(StatusCode code, const std::string& what, std::string advice)
    : std::runtime_error{what}, exit{exit_of(code)}, status{code}, hint{std::move(advice)}
{
    if (hint.empty()) {
        hint = help_for(code).hint;
    }
}

std::string_view reason_in(std::string_view additional_info, std::string_view operand)
{
    if (!additional_info.starts_with(operand)) {
        return additional_info;
    }
    constexpr std::string_view separator = ": ";
    const std::string_view rest = additional_info.substr(operand.size());
    return rest.starts_with(separator) ? rest.substr(separator.size()) : std::string_view{};
}

Failure refused_by_server(StatusCode status, const std::string& what,
                          std::string_view additional_info, std::string_view operand)
{
    Failure failure{status, what};
    failure.reason = reason_in(additional_info, operand);
    if (!failure.reason.empty()) {
        failure.hint.clear();
    }
    return failure;
}

Failure connect_failure(StatusCode status, const std::string& url, const std::string& why)
{
    if (status != status::Bad_CommunicationError || why.empty()) {
        return {status, url};
    }
    std::string advice;
    if (why == std::strerror(ECONNREFUSED)) {
        advice = "nothing listens at this port: check the port, and that the server runs";
    } else if (why == "the host has no address") {
        advice = "check how the host's name is written, and that it is known to the network";
    } else if (why == std::strerror(EHOSTUNREACH) || why == std::strerror(ENETUNREACH)) {
        advice = "check the address, and this machine's network";
    }
    return {status, url + ": " + why, std::move(advice)};
}

Failure refused_by_us(StatusCode status, const std::string& what, const std::string& refusal)
{
    Failure failure{status, what, "-v shows all that was said about it"};
    failure.reason =
        "we ended the connection, as the server's answer is not acceptable: " + refusal;
    return failure;
}

std::string text_of(const Failure& failure, const Output& out)
{
    // In a file a message stays one line, which is searched and cut by other programs.
    const std::size_t columns =
        out.is_terminal() ? std::min<std::size_t>(out.columns(), 100) : out.columns();
    std::string what = safe(failure.what());
    if (failure.status != StatusCode{}) {
        what += ": " + status_text(failure.status);
    }
    constexpr std::string_view program = "busbar: ";
    std::string text = out.styled(Style::Bad, program) + wrap(what, columns - program.size(), 2);
    if (!failure.reason.empty()) {
        text += "\n  " + wrap(safe(failure.reason), columns - 2, 2);
    } else if (failure.status != StatusCode{}) {
        if (const std::string_view meaning = help_for(failure.status).meaning; !meaning.empty()) {
            text += "\n  " + wrap(meaning, columns - 2, 2);
        }
    }
    if (!failure.hint.empty()) {
        text +=
            "\n  " + out.styled(Style::Bold, "hint: ") + wrap(safe(failure.hint), columns - 8, 8);
    }
    return text + lines_of(failure.candidates) + "\n";
}

std::string lines_of(const std::vector<std::string>& candidates)
{
    std::string lines;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (i == max_shown_candidates) {
            return lines + "\n    and others";
        }
        lines += "\n    " + shell_word(safe(candidates[i]));
    }
    return lines;
}

std::string json_of(const Failure& failure)
{
    JsonLine json;
    json.open_object().key("error").open_object().member("message", failure.what());
    if (failure.status != StatusCode{}) {
        json.member("status", failure.status);
        json.member("meaning", help_for(failure.status).meaning);
    }
    if (!failure.reason.empty()) {
        json.member("reason", failure.reason);
    }
    json.member("hint", failure.hint);
    if (!failure.candidates.empty()) {
        json.key("candidates").texts(failure.candidates);
    }
    json.member("exit", static_cast<std::int64_t>(failure.exit));
    return json.close_object().close_object().document() + "\n";
}

} // namespace busbar::tool
