#include "context.hpp"

#include <algorithm>
#include <utility>

#include <CLI/CLI.hpp>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/crypto/security_policy.hpp>

#include "command_line/completion.hpp"
#include "failure.hpp"
#include "server_trust.hpp"
#include "tool/printing/display_text.hpp"

namespace busbar::tool {

namespace {

/// No key of a keyboard, and in no value that anybody writes.
constexpr char mark = '\x1f';

/// "abc is not a thing, perhaps abd is meant; there are ..."
std::string unknown(const std::string& text, const std::string& thing,
                    const std::vector<std::string>& names)
{
    const std::string meant = nearest(text, names);
    return (text.empty() ? "\"\"" : text) + " is not a " + thing +
           (meant.empty() ? "" : ", perhaps " + meant + " is meant") + "; there are " +
           joined(names);
}

std::vector<std::string> policy_names()
{
    std::vector<std::string> names;
    for (const crypto::SecurityPolicy& policy : crypto::security_policies()) {
        names.emplace_back(policy.name);
    }
    return names;
}

/// A check for CLI11: returns an empty text if it is a step.
std::string check_step(const std::string& text)
{
    const auto names = ignorable_steps();
    const bool is_known = std::find(names.begin(), names.end(), text) != names.end();
    return is_known ? "" : unknown(text, "step that can be ignored", names);
}

/// The same.
std::string check_policy(const std::string& text)
{
    const auto names = policy_names();
    return crypto::find_policy_by_name(text) != nullptr ? ""
                                                        : unknown(text, "security policy", names);
}

constexpr std::string_view scheme = "opc.tcp://";
constexpr const char* advice = "write opc.tcp://host:4840, or host:4840";

bool is_digit(char character)
{
    return character >= '0' && character <= '9';
}

bool is_host(std::string_view text)
{
    const bool has_only = std::all_of(text.begin(), text.end(), [](char character) {
        return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z') ||
               is_digit(character) || character == '-' || character == '.' || character == '_';
    });
    // "2:8" is a browse name rather than port 8 of host 2.
    return has_only && !std::all_of(text.begin(), text.end(), is_digit);
}

/// "host:4840", "host:4840/path", "[::1]:4840".
bool is_host_with_port(std::string_view text)
{
    const bool is_v6 = text.starts_with('[');
    const std::size_t colon = is_v6 ? text.find("]:") : text.find(':');
    if (colon == std::string_view::npos) {
        return false;
    }
    const std::string_view port = text.substr(colon + (is_v6 ? 2 : 1));
    const std::string_view host = text.substr(is_v6 ? 1 : 0, colon - (is_v6 ? 1 : 0));
    const bool is_address =
        is_v6 && host.find_first_not_of("0123456789abcdefABCDEF:.%") == std::string_view::npos;
    return !port.empty() && is_digit(port.front()) && (is_address || is_host(host));
}

/// Returns the part between scheme and path.
std::string_view authority_of(std::string_view url)
{
    url.remove_prefix(std::min(scheme.size(), url.size()));
    return url.substr(0, std::min(url.find('/'), url.size()));
}

std::string found_in(std::string_view url)
{
    const std::string_view authority = authority_of(url);
    const std::size_t bracket = authority.rfind(']');
    const std::size_t colon = authority.find(':', bracket == std::string_view::npos ? 0 : bracket);
    if (authority.empty() || colon == 0) {
        return "names no host";
    }
    if (colon == std::string_view::npos) {
        return "is not a URL";
    }
    return "its port is \"" + std::string{authority.substr(colon + 1)} +
           "\", expected a number from 1 to 65535";
}

} // namespace

void when_chosen(CLI::App& command, Run& run, Run function)
{
    command.callback([&run, function = std::move(function)] { run = function; });
}

void add_options(CLI::App& app, Options& options)
{
    app.add_option("-u,--url", options.url,
                   "server, or first argument of a command; or set BUSBAR_URL")
        ->type_name("URL")
        ->default_str("opc.tcp://localhost:4840");
    app.add_option("--profile", options.profile,
                   "server and options of a profile, or @NAME for a URL; or set BUSBAR_PROFILE")
        ->type_name("NAME");
    app.add_option("--user", options.user, "log in by name")->type_name("NAME");
    app.add_option("--password", options.password,
                   "password, visible to other users of this machine; prefer --password-file or "
                   "BUSBAR_PASSWORD")
        ->type_name("TEXT");
    app.add_option("--password-file", options.password_file, "password; or set BUSBAR_PASSWORD")
        ->type_name("FILE");
    auto* certificate =
        app.add_option("--user-certificate", options.user_certificate, "log in by certificate")
            ->type_name("FILE");
    app.add_option("--user-key", options.user_key, "its private key")
        ->type_name("FILE")
        ->needs(certificate);
    app.add_option("--policy", options.policies, "security policies to accept, best first")
        ->type_name("A,B,...")
        ->delimiter(',')
        ->check(check_policy, "", command_line::values_name(policy_names()))
        ->expected(1);
    app.add_option("--mode", options.mode,
                   "lowest message security to accept: Sign or SignAndEncrypt")
        ->check(CLI::IsMember({"Sign", "SignAndEncrypt"}))
        ->type_name("MODE")
        ->capture_default_str();
    app.add_flag("--insecure", options.is_insecure, "do without security if there is none");
    app.add_option("--pki", options.pki, "folder of certificates, see `busbar cert`")
        ->type_name("DIR");
    app.add_flag("--trust", options.trusts, "trust the server's certificate from now on");
    app.add_option("--ignore", options.ignored, "accept a certificate that fails this check")
        ->check(check_step, "", command_line::values_name(ignorable_steps()))
        ->type_name("STEP")
        ->expected(1)
        ->take_all();
    app.add_option("--timeout", options.timeout, "how long to wait for the server")
        ->check(CLI::Range(0.1, 86'400.0))
        ->type_name("SECONDS")
        ->capture_default_str();
    app.add_option("--key-log", options.key_log,
                   "for test benches: write the channels' keys, for Wireshark 4.4 and later")
        ->type_name("FILE");
    app.add_flag("--json", options.is_json, "write JSON, for scripts");
    app.add_flag("-v,--verbose", options.is_verbose, "tell what is done, on standard error");
}

std::string check_option(const std::string& name, const std::vector<std::string>& values)
{
    if (name == "mode") {
        const bool is_mode = values.front() == "Sign" || values.front() == "SignAndEncrypt";
        return is_mode ? "" : "expected Sign or SignAndEncrypt, found " + values.front();
    }
    for (const std::string& value : values) {
        std::string problem = name == "policy"   ? check_policy(value)
                              : name == "ignore" ? check_step(value)
                                                 : std::string{};
        if (!problem.empty()) {
            return problem;
        }
    }
    return {};
}

void Context::warn(const std::string& label, const std::string& text)
{
    const std::string begin = "busbar: " + label + ": ";
    const std::string lines = wrap(begin + safe(text), err.columns(), 2);
    err.line(err.styled(Style::Uncertain, begin) + lines.substr(begin.size()));
}

std::vector<std::string> protected_arguments(int count, char** arguments)
{
    int separator = 1; // where "--" is, or the end
    while (separator < count && std::string_view{arguments[separator]} != "--") {
        ++separator;
    }
    std::vector<std::string> result;
    for (int i = count - 1; i > 0; --i) {
        const std::string argument{arguments[i]};
        const bool is_list = argument.starts_with('[') && argument.ends_with(']');
        if (i > separator) {
            result.push_back(mark + argument);
        } else if (i < separator) {
            result.push_back(is_list ? mark + argument : argument);
        }
    }
    return result;
}

void unmark(std::string& argument)
{
    if (argument.starts_with(mark)) {
        argument.erase(0, 1);
    }
}

void take_url(std::vector<std::string>& arguments, Options& options, std::size_t others)
{
    std::for_each(arguments.begin(), arguments.end(), unmark);
    unmark(options.user);
    unmark(options.password);
    if (arguments.size() <= others) {
        return;
    }
    if (arguments.front().starts_with('@') && arguments.front().size() > 1) {
        options.given.erase("url");
        apply_profile(arguments.front().substr(1), options);
        arguments.erase(arguments.begin());
    } else if (is_url(arguments.front())) {
        options.url = arguments.front();
        arguments.erase(arguments.begin());
    }
}

void take_only_url(std::vector<std::string>& arguments, Options& options)
{
    if (arguments.size() > 1) {
        throw Failure{Exit::Usage, arguments[1] + ": one argument too many"};
    }
    take_url(arguments, options);
    if (!arguments.empty()) {
        options.url = arguments.front(); // nothing else is meant than a host
    }
}

void take_url_before(std::vector<std::string>& arguments, Options& options)
{
    take_url(arguments, options);
    if (arguments.empty()) {
        throw Failure{Exit::Usage, "no node is given", "find one with `busbar browse`"};
    }
}

bool is_url(std::string_view text)
{
    // A NodeId may contain the URI of a namespace; then the part before :// is not a scheme.
    const std::size_t end = text.find("://");
    const bool has_scheme = end != std::string_view::npos &&
                            text.substr(0, end).find_first_of("=;/") == std::string_view::npos;
    return has_scheme || is_host_with_port(text);
}

std::string complete_url(const std::string& text)
{
    const std::size_t end = text.find("://");
    if (end != std::string::npos && !channel::is_same_host(text.substr(0, end + 3), scheme)) {
        throw Failure{Exit::Usage, text + ": " + text.substr(0, end) + " is not supported", advice};
    }
    std::string url = end == std::string::npos ? std::string{scheme} + text : text;
    if (!channel::EndpointUrl::parse(url)) {
        throw Failure{Exit::Usage, text + ": " + found_in(url), advice};
    }
    return url;
}

std::string host_of(const std::string& url)
{
    const auto parsed = channel::EndpointUrl::parse(url);
    return parsed ? parsed->host : std::string{};
}

} // namespace busbar::tool
