#include "credentials.hpp"

#include <cstdlib>
#include <iostream>

#include <termios.h>
#include <unistd.h>

#include <busbar/core/status_codes.hpp>
#include <busbar/crypto/own_certificate.hpp>

#include "tool/printing/file.hpp"

namespace busbar::tool {

namespace {

/// Keeps the terminal from showing typed characters as long as this object exists.
class SilentTerminal {
public:
    SilentTerminal()
    {
        ::tcgetattr(STDIN_FILENO, &before_);
        ::termios silent = before_;
        silent.c_lflag &= ~static_cast<::tcflag_t>(ECHO);
        ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
    }
    SilentTerminal(const SilentTerminal&) = delete;
    SilentTerminal& operator=(const SilentTerminal&) = delete;
    ~SilentTerminal() { ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_); }

private:
    ::termios before_{};
};

std::string type(Context& context, const std::string& prompt)
{
    context.err.write(prompt);
    std::string text;
    {
        const SilentTerminal silent;
        std::getline(std::cin, text);
    }
    context.err.write("\n");
    return text;
}

std::string ask_password(Context& context)
{
    if (::isatty(STDIN_FILENO) != 1 || !context.err.is_terminal()) {
        throw Failure{Exit::Usage, "there is no password for " + context.options.user,
                      "give --password-file FILE or set BUSBAR_PASSWORD"};
    }
    return type(context, "Password of " + context.options.user + ": ");
}

std::string read_password(const std::string& path)
{
    const std::string text = read_file(path);
    std::string password = text.substr(0, text.find('\n'));
    if (password.empty()) {
        throw Failure{Exit::Usage, path + ": no password in it", "its first line is the password"};
    }
    return password;
}

std::string password_of(Context& context)
{
    const Options& options = context.options;
    if (!options.password_file.empty()) {
        return read_password(options.password_file);
    }
    if (!options.password.empty()) {
        context.warn("warning", "others on this machine can read passwords of arguments");
        return options.password;
    }
    const char* const variable = std::getenv("BUSBAR_PASSWORD");
    return variable != nullptr ? variable : ask_password(context);
}

crypto::Secret read_secret(const std::string& path)
{
    return crypto::Secret{std::string_view{read_file(path)}};
}

client::CertificateUser certificate_user(const Options& options)
{
    if (options.user_key.empty()) {
        throw Failure{Exit::Usage, "the user's certificate has no key", "give --user-key FILE"};
    }
    const auto certificate =
        crypto::Certificate::parse_file(read_secret(options.user_certificate).span());
    if (!certificate) {
        throw Failure{certificate.error(), options.user_certificate};
    }
    const auto key = crypto::PrivateKey::parse(read_secret(options.user_key).span());
    if (!key) {
        throw Failure{key.error(), options.user_key,
                      "it must be an RSA key without a passphrase, PEM or DER"};
    }
    if (!key->belongs_to(*certificate)) {
        throw Failure{Exit::Usage,
                      options.user_key + ": not the key of " + options.user_certificate};
    }
    return {*certificate, std::make_shared<const crypto::PrivateKey>(*key)};
}

} // namespace

Credentials::Credentials(Context& context, LogSink& log) : context_{&context}
{
    try {
        open(log);
    } catch (const Failure& failure) {
        if (!context.options.is_insecure) {
            throw;
        }
        missing_ = failure;
    }
}

void Credentials::open(LogSink& log)
{
    pki_.emplace(context_->options, log);
    identity_ = pki_->identity();
    trust_.emplace(*pki_, *context_, log);
}

Checked<void> Credentials::validate(const crypto::CertificateChain& chain,
                                    const crypto::ValidationContext& context)
{
    was_asked_ = true;
    if (trust_) {
        return trust_->validate(chain, context);
    }
    return refuse({status::Bad_CertificateUntrusted, "Trust List Check", missing_->what(),
                   "Part 4, 6.1.3, Table 100", missing_->hint});
}

std::string Credentials::application_uri() const
{
    return identity_ ? identity_->certificates.front().application_uri() : Pki::application_uri();
}

bool Credentials::has_refused() const
{
    return trust_ ? trust_->has_refused() : was_asked_;
}

bool Credentials::reconsider()
{
    return trust_ && trust_->reconsider(*context_);
}

Failure Credentials::failure() const
{
    return trust_ ? trust_->failure() : *missing_;
}

client::UserIdentity user_of(Context& context)
{
    if (!context.options.user_certificate.empty()) {
        return certificate_user(context.options);
    }
    if (!context.options.user.empty()) {
        return client::NamedUser{context.options.user, password_of(context)};
    }
    return client::AnonymousUser{};
}

crypto::Secret new_password(Context& context, const std::string& user, const std::string& file)
{
    if (!file.empty()) {
        return crypto::Secret{std::string_view{read_password(file)}};
    }
    if (::isatty(STDIN_FILENO) != 1 || !context.err.is_terminal()) {
        throw Failure{Exit::Usage, "there is no new password for " + user,
                      "give --new-password-file FILE"};
    }
    const std::string first = type(context, "New password of " + user + ": ");
    if (first.empty() || type(context, "Again: ") != first) {
        throw Failure{Exit::Usage, "the passwords are empty or differ"};
    }
    return crypto::Secret{std::string_view{first}};
}

} // namespace busbar::tool
