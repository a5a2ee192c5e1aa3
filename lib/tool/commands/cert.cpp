#include <array>
#include <memory>
#include <sstream>

#include <unistd.h>

#include <busbar/core/status_codes.hpp>
#include <busbar/net/system.hpp>

#include "commands.hpp"
#include "tool/connection/logs.hpp"
#include "tool/connection/pki.hpp"
#include "tool/connection/server_trust.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool {

namespace {

using crypto::StoreEntry;
using crypto::StoreList;

constexpr std::array lists{StoreList::Own, StoreList::Trusted, StoreList::Issuers,
                           StoreList::Rejected};

/// The arguments of the subcommands.
struct CertArguments {
    std::string certificate; // thumbprint, the beginning of one, or a file
    std::string file;
    std::uint32_t valid_days{crypto::default_valid_days};
    bool is_forced{false};
    bool is_issuer{false};
};

struct Found {
    StoreList list;
    StoreEntry entry;
};

/// Finds a certificate by its thumbprint or enough of its first digits.
Found find(Pki& pki, const std::string& thumbprint)
{
    const std::string wanted = crypto::spelled_thumbprint(thumbprint);
    std::optional<Found> found;
    for (const StoreList list : lists) {
        for (StoreEntry& entry : pki.store().list(list)) {
            if (wanted.size() < min_thumbprint_digits || !entry.thumbprint.starts_with(wanted)) {
                continue;
            }
            if (found && found->entry.thumbprint != entry.thumbprint) {
                throw Failure{Exit::Usage, thumbprint + ": more than one begins like this",
                              "give more of the thumbprint"};
            }
            found = Found{list, std::move(entry)};
        }
    }
    if (!found) {
        throw Failure{Exit::Failed, thumbprint + ": no such certificate in " + pki.folder(),
                      "see `busbar cert list`; at least four digits of the thumbprint, or a file"};
    }
    return *std::move(found);
}

std::vector<std::byte> read(const std::string& path)
{
    const std::string text = read_file(path);
    const auto bytes = std::as_bytes(std::span{text});
    return {bytes.begin(), bytes.end()};
}

/// True for a name with a folder or an ending, even if the file does not exist.
bool is_file(const std::string& text)
{
    return text.find_first_of("/.") != std::string::npos || ::access(text.c_str(), F_OK) == 0;
}

std::string_view kind_name(const StoreEntry& entry)
{
    return entry.kind == StoreEntry::Kind::Certificate ? "certificate" : "revocation list";
}

void append_json(JsonLine& json, StoreList list, const StoreEntry& entry)
{
    json.open_object().member("list", crypto::name(list)).member("kind", kind_name(entry));
    json.member("subject", entry.subject).member("issuer", entry.issuer);
    json.member("thumbprint", entry.thumbprint).member("file", entry.file);
    json.member("validFrom", entry.valid_from).member("validTo", entry.valid_to).close_object();
}

Exit list(Context& context, Pki& pki)
{
    JsonLine json;
    json.open_array();
    Table table{{{"LIST"}, {"THUMBPRINT", 12}, {"VALID TO", 10}, {"SUBJECT", 16}}};
    const DateTime now = net::SystemWallClock{}.now();
    for (const StoreList from : lists) {
        for (const StoreEntry& entry : pki.store().list(from)) {
            append_json(json, from, entry);
            const bool is_over = !entry.valid_to.is_null() && entry.valid_to < now;
            const bool is_list = entry.kind == StoreEntry::Kind::RevocationList;
            table.add(
                {{std::string{crypto::name(from)},
                  from == StoreList::Rejected ? Style::Bad : Style::Plain},
                 {entry.thumbprint},
                 {to_string(entry.valid_to).substr(0, 10), is_over ? Style::Bad : Style::Plain},
                 {(is_list ? "revocation list of " : "") + safe(entry.subject)}});
        }
    }
    if (context.options.is_json) {
        context.out.line(json.close_array().document());
    } else if (table.row_count() == 0) {
        context.out.line("No certificates in " + safe(pki.folder()));
    } else {
        table.print(context.out);
    }
    return Exit::Good;
}

void report(Context& context, const std::string& done, StoreList list, const StoreEntry& entry)
{
    if (context.options.is_json) {
        JsonLine json;
        append_json(json, list, entry);
        context.out.line(json.document());
    } else {
        context.out.line(wrap(done + " " + entry.thumbprint + " (" + safe(entry.subject) + ")",
                              context.out.columns(), 2));
    }
}

Exit create(Context& context, Pki& pki, const CertArguments& arguments)
{
    if (pki.own() && !arguments.is_forced &&
        !confirm(context, "There is a certificate already. Servers have to trust the new one. "
                          "Replace it?")) {
        throw Failure{Exit::Failed, "there is a certificate already",
                      "--force replaces it; the old one is kept in own/replaced"};
    }
    const crypto::OwnCertificate own = pki.replace_own(arguments.valid_days);
    const crypto::Certificate& leaf = own.certificates.front();
    StoreEntry entry;
    entry.file = "own/certs/own.der";
    entry.subject = leaf.subject();
    entry.issuer = leaf.subject();
    entry.thumbprint = leaf.thumbprint_text();
    entry.valid_from = leaf.valid_from();
    entry.valid_to = leaf.valid_to();
    report(context, "created", StoreList::Own, entry);
    return Exit::Good;
}

Exit trust(Context& context, Pki& pki, const CertArguments& arguments)
{
    const StoreList to = arguments.is_issuer ? StoreList::Issuers : StoreList::Trusted;
    if (is_file(arguments.certificate)) {
        const auto contents = read(arguments.certificate);
        report(context, "trusted", to,
               expect(pki.store().add(to, contents), arguments.certificate));
        return Exit::Good;
    }
    const Found found = find(pki, arguments.certificate);
    if (found.list != to) {
        expect(pki.store().move(found.entry.thumbprint, found.list, to), arguments.certificate);
    }
    report(context, "trusted", to, found.entry);
    return Exit::Good;
}

Exit reject(Context& context, Pki& pki, const CertArguments& arguments)
{
    const Found found = find(pki, arguments.certificate);
    if (found.list != StoreList::Rejected) {
        expect(pki.store().move(found.entry.thumbprint, found.list, StoreList::Rejected),
               arguments.certificate);
    }
    report(context, "rejected", StoreList::Rejected, found.entry);
    return Exit::Good;
}

/// Ours, if nothing is named.
std::string thumbprint_of(Pki& pki, const CertArguments& arguments)
{
    if (!arguments.certificate.empty()) {
        return find(pki, arguments.certificate).entry.thumbprint;
    }
    const auto own = pki.own();
    if (!own) {
        throw Failure{Exit::Failed, "there is no certificate yet", "`busbar cert create` makes it"};
    }
    return own->certificates.front().thumbprint_text();
}

void print_lines(Context& context, const std::string& text)
{
    constexpr std::size_t value_column = 14;
    std::istringstream lines{text};
    for (std::string line; std::getline(lines, line);) {
        context.out.line(wrap(line, context.out.columns(), value_column));
    }
}

/// Shows a certificate file, which need not be in any list.
Exit show_file(Context& context, const std::string& path)
{
    const std::vector<std::byte> contents = read(path);
    const auto certificate = crypto::Certificate::parse_file(contents);
    const auto revocations = crypto::RevocationList::parse_file(contents);
    if (!certificate && !revocations) {
        throw Failure{Exit::Usage, path + ": neither a certificate nor a revocation list",
                      "expected one, as DER or PEM"};
    }
    const std::string text = certificate ? crypto::certificate_text(*certificate)
                                         : crypto::revocation_list_text(*revocations);
    if (context.options.is_json) {
        JsonLine json;
        context.out.line(
            json.open_object().member("file", path).member("text", text).close_object().document());
    } else {
        print_lines(context, text);
    }
    return Exit::Good;
}

Exit show(Context& context, Pki& pki, const CertArguments& arguments)
{
    if (is_file(arguments.certificate)) {
        return show_file(context, arguments.certificate);
    }
    const std::string thumbprint = thumbprint_of(pki, arguments);
    const Found found = find(pki, thumbprint);
    if (context.options.is_json) {
        report(context, "", found.list, found.entry);
        return Exit::Good;
    }
    std::string text = expect(pki.store().show(thumbprint), thumbprint);
    text += "File:         " + safe(pki.folder() + "/" + found.entry.file);
    print_lines(context, text);
    return Exit::Good;
}

Exit export_certificate(Context& context, Pki& pki, const CertArguments& arguments)
{
    const Found found = find(pki, thumbprint_of(pki, arguments));
    if (found.entry.kind != StoreEntry::Kind::Certificate) {
        throw Failure{Exit::Usage, arguments.certificate + ": a revocation list"};
    }
    const auto certificates = expect(
        crypto::read_certificates(read(pki.folder() + "/" + found.entry.file)), found.entry.file);
    const auto der = certificates.front().der();
    write_file(arguments.file, {reinterpret_cast<const char*>(der.data()), der.size()});
    report(context, "exported", found.list, found.entry);
    return Exit::Good;
}

using Action = Exit (*)(Context&, Pki&, const CertArguments&);

CLI::App* add(CLI::App& cert, Run& run, const std::shared_ptr<CertArguments>& arguments,
              const char* name, const char* text, Action action)
{
    auto* command = cert.add_subcommand(name, text);
    command->fallthrough();
    when_chosen(*command, run, [arguments, action](Context& context) {
        VerboseLog log{context.options.is_verbose};
        Pki pki{context.options, log};
        return action(context, pki, *arguments);
    });
    return command;
}

} // namespace

void add_cert(CLI::App& app, Run& run)
{
    auto* cert = app.add_subcommand("cert", "Manages certificates, your own and trusted ones.");
    cert->require_subcommand(1);
    const auto arguments = std::make_shared<CertArguments>();
    const auto name = [&](CLI::App* command, bool is_required) {
        command
            ->add_option("CERTIFICATE", arguments->certificate,
                         "thumbprint, its first digits, or a file")
            ->required(is_required);
    };

    add(*cert, run, arguments, "list", "Lists all certificates.",
        [](Context& context, Pki& pki, const CertArguments&) { return list(context, pki); });
    auto* made = add(*cert, run, arguments, "create", "Makes our certificate and key.", create);
    made->add_option("--days", arguments->valid_days, "how long it is valid")
        ->check(CLI::Range(1, 36'500))
        ->capture_default_str();
    made->add_flag("--force", arguments->is_forced, "replace the one that is there");
    auto* trusted = add(*cert, run, arguments, "trust", "Trusts a certificate.", trust);
    name(trusted, true);
    trusted->add_flag("--issuer", arguments->is_issuer,
                      "know it as an authority only, without trusting all that it signed");
    name(add(*cert, run, arguments, "reject", "Stops trusting a certificate.", reject), true);
    name(add(*cert, run, arguments, "show", "Shows what a certificate, or ours, says.", show),
         false);
    auto* exported =
        add(*cert, run, arguments, "export",
            "Writes a certificate, or ours, to a file for others to trust.", export_certificate);
    exported->add_option("FILE", arguments->file, "DER file to write")->required();
    name(exported, false);
}

} // namespace busbar::tool
