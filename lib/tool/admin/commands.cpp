#include "commands.hpp"

#include <utility>

#include <busbar/crypto/self_signed.hpp>
#include <busbar/net/system.hpp>

#include "tool/connection/server_trust.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::admin {

Group::Group(CLI::App& parent, Run& run, const char* name, const char* text)
    : app_{name != nullptr ? parent.add_subcommand(name, text) : &parent}, run_{&run}
{
    if (name != nullptr) {
        app_->require_subcommand(1);
        app_->fallthrough();
    }
}

CLI::App* Group::add(const char* name, const char* text, std::size_t words, const char* word_names,
                     Action action, Connection::Endurance endurance)
{
    return add(name, text, word_names, std::optional{words}, action, endurance);
}

CLI::App* Group::add_any(const char* name, const char* text, const char* word_names, Action action)
{
    return add(name, text, word_names, std::nullopt, action, Connection::Endurance::Short);
}

CLI::App* Group::add(const char* name, const char* text, const char* word_names,
                     std::optional<std::size_t> words, Action action,
                     Connection::Endurance endurance)
{
    auto* command = app_->add_subcommand(name, text);
    command->fallthrough();
    command->add_option(word_names, arguments_->words,
                        words == 0 ? "[URL]" : "[URL] before the others");
    command->callback([run = run_, arguments = arguments_, words, action, endurance,
                       names = std::string{word_names}] {
        *run = [arguments, words, action, endurance, names](Context& context) {
            take_url(arguments->words, context.options, words.value_or(0));
            if (words && arguments->words.size() != *words) {
                throw Failure{Exit::Usage,
                              std::to_string(arguments->words.size()) + " arguments instead of " +
                                  std::to_string(*words),
                              "expected " + (words == 0 ? std::string{"none but a URL"} : names)};
            }
            Connection connection{
                context, arguments->log.is_followed ? Connection::Endurance::Lasting : endurance};
            return action(context, connection, *arguments);
        };
    });
    return command;
}

void make_sure(Context& context, const AdminArguments& arguments, const std::string& question)
{
    if (!arguments.is_sure && !confirm(context, question)) {
        throw Failure{Exit::Failed, "nothing was done", "--yes does it without a question"};
    }
}

Exit report(Context& context, const std::string& what)
{
    if (context.options.is_json) {
        JsonLine json;
        context.out.line(json.open_object().member("done", what).close_object().document());
    } else {
        context.out.line(wrap(what, context.out.columns(), 2));
    }
    return Exit::Good;
}

namespace {

std::string joined(const std::vector<std::string>& texts)
{
    std::string all;
    for (const std::string& text : texts) {
        all += (all.empty() ? "" : ", ") + text;
    }
    return all;
}

} // namespace

void print_certificates(Context& context, const std::vector<CertificateRow>& rows)
{
    print_trust(context, rows, {});
}

void print_trust(Context& context, const std::vector<CertificateRow>& rows,
                 const std::vector<RevocationRow>& revocations)
{
    JsonLine json;
    json.open_array();
    Table table{{{"LIST"},
                 {"COMMON NAME", 12},
                 {"ORGANIZATION"},
                 {"DOMAIN"},
                 {"VALID TO", 10},
                 {"THUMBPRINT", 12}}};
    const DateTime now = net::SystemWallClock{}.now();
    for (const auto& [list, certificate] : rows) {
        const crypto::CertificateSubject subject = crypto::subject_of(certificate);
        const std::string hosts = joined(certificate.host_names());
        json.open_object().member("list", list).member("commonName", subject.common_name);
        json.member("subject", certificate.subject());
        json.member("organization", subject.organization).member("domain", hosts);
        json.member("validFrom", certificate.valid_from());
        json.member("validTo", certificate.valid_to());
        json.member("thumbprint", certificate.thumbprint_text()).close_object();
        table.add({{list, list == "rejected" ? Style::Bad : Style::Plain},
                   {safe(subject.common_name)},
                   {safe(subject.organization)},
                   {safe(hosts)},
                   {to_string(certificate.valid_to()).substr(0, 10),
                    certificate.valid_to() < now ? Style::Bad : Style::Plain},
                   {certificate.thumbprint_text()}});
    }
    for (const auto& [list, revoked] : revocations) {
        const DateTime next = revoked.next_update();
        json.open_object().member("list", list + " crl").member("issuer", revoked.issuer());
        json.member("revoked", static_cast<std::int64_t>(revoked.size()));
        json.member("thisUpdate", revoked.this_update()).member("nextUpdate", next);
        json.member("thumbprint", revoked.thumbprint_text()).close_object();
        table.add({{list + " crl"},
                   {safe(revoked.issuer())},
                   {""},
                   {std::to_string(revoked.size()) + " revoked"},
                   {next.is_null() ? "" : to_string(next).substr(0, 10),
                    !next.is_null() && next < now ? Style::Bad : Style::Plain},
                   {revoked.thumbprint_text()}});
    }
    if (context.options.is_json) {
        context.out.line(json.close_array().document());
    } else if (table.row_count() == 0) {
        context.out.line("No certificates");
    } else {
        table.print(context.out);
    }
}

const CertificateRow& find(const std::vector<CertificateRow>& rows, const std::string& thumbprint)
{
    const std::string wanted = crypto::spelled_thumbprint(thumbprint);
    const CertificateRow* found = nullptr;
    for (const CertificateRow& row : rows) {
        if (wanted.size() < min_thumbprint_digits ||
            !row.certificate.thumbprint_text().starts_with(wanted)) {
            continue;
        }
        if (found != nullptr && !(found->certificate == row.certificate)) {
            throw Failure{Exit::Usage, thumbprint + ": more than one begins like this",
                          "give more of the thumbprint"};
        }
        found = &row;
    }
    if (found == nullptr) {
        throw Failure{Exit::Failed, thumbprint + ": the server has no such certificate",
                      "see `busbar admin trust list`; at least four digits of the thumbprint"};
    }
    return *found;
}

} // namespace busbar::tool::admin
