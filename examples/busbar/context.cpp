#include "context.hpp"

#include <CLI/CLI.hpp>

#include "display_text.hpp"
#include "ignored_steps.hpp"

namespace busbar::cli {

void add_options(CLI::App& app, Options& options)
{
    app.add_option("-u,--url", options.url, "server, or first argument of a command")
        ->envname("BUSBAR_URL")
        ->type_name("URL")
        ->capture_default_str();
    app.add_option("--user", options.user, "log in by name")->type_name("NAME");
    app.add_option("--password", options.password, "others can read it here: better one of these:")
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
        ->expected(1);
    app.add_option("--mode", options.mode, "least security: Sign, SignAndEncrypt")
        ->check(CLI::IsMember({"Sign", "SignAndEncrypt"}))
        ->type_name("MODE")
        ->capture_default_str();
    app.add_flag("--insecure", options.is_insecure, "do without security if there is none");
    app.add_option("--pki", options.pki, "folder of certificates, see `busbar cert`")
        ->type_name("DIR");
    app.add_flag("--trust", options.trusts, "trust the server's certificate from now on");
    app.add_option("--ignore", options.ignored, "let a server's certificate pass though it fails")
        ->check(CLI::IsMember(ignorable_steps()))
        ->type_name("STEP")
        ->expected(1)
        ->take_all();
    app.add_option("--timeout", options.timeout, "wait so long for the server")
        ->check(CLI::Range(0.1, 86'400.0))
        ->type_name("SECONDS")
        ->capture_default_str();
    app.add_flag("--json", options.is_json, "write JSON, for scripts");
    app.add_flag("-v,--verbose", options.is_verbose, "tell what is done, on standard error");
}

void Context::warn(const std::string& label, const std::string& text)
{
    const std::string begin = "busbar: " + label + ": ";
    const std::string lines = wrap(begin + safe(text), err.columns(), 2);
    err.line(err.styled(Style::Uncertain, begin) + lines.substr(begin.size()));
}

std::vector<std::string> protected_arguments(int count, char** arguments)
{
    std::vector<std::string> result;
    for (int i = count - 1; i > 0; --i) {
        const std::string argument{arguments[i]};
        const bool is_list = argument.starts_with('[') && argument.ends_with(']');
        result.push_back((is_list ? " " : "") + argument);
    }
    return result;
}

std::string whole(const std::string& argument)
{
    return argument.starts_with(" [") ? argument.substr(1) : argument;
}

bool is_url(const std::string& text)
{
    return text.starts_with("opc.tcp://");
}

void take_url(std::vector<std::string>& arguments, Options& options)
{
    if (!arguments.empty() && is_url(arguments.front())) {
        options.url = arguments.front();
        arguments.erase(arguments.begin());
    }
}

void take_only_url(std::vector<std::string>& arguments, Options& options)
{
    take_url(arguments, options);
    if (!arguments.empty()) {
        throw Failure{Exit::Usage, arguments.front() + ": no URL",
                      "URLs look like opc.tcp://host:4840/path"};
    }
}

void take_url_before(std::vector<std::string>& arguments, Options& options)
{
    take_url(arguments, options);
    if (arguments.empty()) {
        throw Failure{Exit::Usage, "no node is given", "find one with `busbar browse`"};
    }
}

} // namespace busbar::cli
