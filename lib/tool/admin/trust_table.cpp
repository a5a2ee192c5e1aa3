#include "trust_table.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/net/system.hpp>

#include "tool/connection/failure.hpp"
#include "tool/connection/pki.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::admin {

namespace {

std::string joined(const std::vector<std::string>& texts)
{
    std::string all;
    for (const std::string& text : texts) {
        all += (all.empty() ? "" : ", ") + text;
    }
    return all;
}

/// Position of a list among the others.
std::ptrdiff_t place_of(const std::string& list)
{
    constexpr std::array lists{"own", "trusted", "issuers", "rejected"};
    return std::find(lists.begin(), lists.end(), list) - lists.begin();
}

std::string key_of(const CertificateRow& row, const std::string& column)
{
    const crypto::CertificateSubject subject = crypto::subject_of(row.certificate);
    return column == "organization" ? subject.organization
           : column == "domain"     ? joined(row.certificate.host_names())
           : column == "validity"   ? to_string(row.certificate.valid_to())
                                    : subject.common_name;
}

/// Revocation lists have no organization and no domain.
std::string key_of(const RevocationRow& row, const std::string& column)
{
    return column == "validity" ? to_string(row.revocations.next_update())
                                : row.revocations.issuer();
}

template <typename Row>
void sort(std::vector<Row>& rows, const TrustOrder& order)
{
    std::stable_sort(rows.begin(), rows.end(), [&](const Row& a, const Row& b) {
        if (a.list != b.list) {
            return place_of(a.list) < place_of(b.list);
        }
        const std::string of_a = key_of(a, order.column);
        const std::string of_b = key_of(b, order.column);
        return order.is_descending ? of_b < of_a : of_a < of_b;
    });
}

/// Appends the members; leaves the object open.
void append_json(JsonLine& json, const CertificateRow& row)
{
    const crypto::CertificateSubject subject = crypto::subject_of(row.certificate);
    json.open_object().member("list", row.list).member("commonName", subject.common_name);
    json.member("subject", row.certificate.subject());
    json.member("organization", subject.organization);
    json.member("domain", joined(row.certificate.host_names()));
    json.member("validFrom", row.certificate.valid_from());
    json.member("validTo", row.certificate.valid_to());
    json.member("thumbprint", row.certificate.thumbprint_text());
}

/// The same for a revocation list.
void append_json(JsonLine& json, const RevocationRow& row)
{
    const crypto::RevocationList& list = row.revocations;
    json.open_object().member("list", row.list + " crl").member("issuer", list.issuer());
    json.member("revoked", static_cast<std::int64_t>(list.size()));
    json.member("thisUpdate", list.this_update()).member("nextUpdate", list.next_update());
    json.member("file", crypto::file_name_of(list)).member("thumbprint", list.thumbprint_text());
}

void print_json(Context& context, const TrustRows& rows)
{
    JsonLine json;
    json.open_array();
    for (const CertificateRow& row : rows.certificates) {
        append_json(json, row);
        json.close_object();
    }
    for (const RevocationRow& row : rows.revocations) {
        append_json(json, row);
        json.close_object();
    }
    context.out.line(json.close_array().document());
}

Cell end_of_validity(DateTime end)
{
    const bool is_over = !end.is_null() && end < net::SystemWallClock{}.now();
    return {end.is_null() ? "" : to_string(end).substr(0, 10), is_over ? Style::Bad : Style::Plain};
}

void print_table(Context& context, const std::vector<CertificateRow>& rows)
{
    Table table{{{"LIST"},
                 {"COMMON NAME", 12},
                 {"ORGANIZATION"},
                 {"DOMAIN"},
                 {"VALID TO", 10},
                 {"THUMBPRINT", 12}}};
    for (const auto& [list, certificate] : rows) {
        const crypto::CertificateSubject subject = crypto::subject_of(certificate);
        table.add({{list, list == "rejected" ? Style::Bad : Style::Plain},
                   {safe(subject.common_name)},
                   {safe(subject.organization)},
                   {safe(joined(certificate.host_names()))},
                   end_of_validity(certificate.valid_to()),
                   {certificate.thumbprint_text()}});
    }
    if (table.row_count() != 0) {
        table.print(context.out);
    }
}

void print_table(Context& context, const std::vector<RevocationRow>& rows)
{
    Table table{{{"LIST", 11},
                 {"ISSUER", 12},
                 {"REVOKED", 9},
                 {"VALID FROM", 10},
                 {"NEXT UPDATE", 10},
                 {"FILE"},
                 {"THUMBPRINT", 12}}};
    for (const auto& [list, revocations] : rows) {
        table.add({{list + " crl"},
                   {safe(revocations.issuer())},
                   {std::to_string(revocations.size()) + " revoked"},
                   {to_string(revocations.this_update()).substr(0, 10)},
                   end_of_validity(revocations.next_update()),
                   {safe(crypto::file_name_of(revocations))},
                   {revocations.thumbprint_text()}});
    }
    if (table.row_count() != 0) {
        table.print(context.out);
    }
}

void print_lines(Context& context, const std::string& text)
{
    constexpr std::size_t value_column = 14;
    std::istringstream lines{text};
    for (std::string line; std::getline(lines, line);) {
        context.out.line(wrap(line, context.out.columns(), value_column));
    }
}

template <typename Row>
void print_one(Context& context, const Row& row, const std::string& list, const std::string& text)
{
    if (context.options.is_json) {
        JsonLine json;
        append_json(json, row);
        context.out.line(json.member("text", text).close_object().document());
    } else {
        print_lines(context, "List:         " + list + "\n" + text);
    }
}

template <typename Row, typename Thumbprint>
const Row* find_one(const std::vector<Row>& rows, const std::string& thumbprint,
                    const Thumbprint& thumbprint_of)
{
    const std::string wanted = crypto::spelled_thumbprint(thumbprint);
    const Row* found = nullptr;
    for (const Row& row : rows) {
        if (wanted.size() < min_thumbprint_digits || !thumbprint_of(row).starts_with(wanted)) {
            continue;
        }
        if (found != nullptr && thumbprint_of(*found) != thumbprint_of(row)) {
            throw Failure{Exit::Usage, thumbprint + ": more than one begins like this",
                          "give more of the thumbprint"};
        }
        found = found == nullptr ? &row : found;
    }
    return found;
}

} // namespace

void print_trust(Context& context, TrustRows rows, const TrustOrder& order)
{
    sort(rows.certificates, order);
    sort(rows.revocations, order);
    if (context.options.is_json) {
        print_json(context, rows);
    } else if (rows.certificates.empty() && rows.revocations.empty()) {
        context.out.line("No certificates");
    } else {
        print_table(context, rows.certificates);
        print_table(context, rows.revocations);
    }
}

void print_details(Context& context, const CertificateRow& row)
{
    print_one(context, row, row.list, crypto::certificate_text(row.certificate));
}

void print_own(Context& context, const CertificateRow& row)
{
    if (context.options.is_json) {
        JsonLine json;
        json.open_array();
        append_json(json, row);
        json.member("text", crypto::certificate_text(row.certificate)).close_object();
        context.out.line(json.close_array().document());
        return;
    }
    print_table(context, std::vector<CertificateRow>{row});
    print_details(context, row);
}

void print_details(Context& context, const RevocationRow& row)
{
    print_one(context, row, row.list + " crl", crypto::revocation_list_text(row.revocations));
}

const CertificateRow& find(const std::vector<CertificateRow>& rows, const std::string& thumbprint)
{
    const CertificateRow* const found = find_one(rows, thumbprint, [](const CertificateRow& row) {
        return row.certificate.thumbprint_text();
    });
    if (found == nullptr) {
        throw Failure{Exit::Failed, thumbprint + ": the server has no such certificate",
                      "see `busbar admin trust list`; at least four digits of the thumbprint"};
    }
    return *found;
}

const RevocationRow* find(const std::vector<RevocationRow>& rows, const std::string& thumbprint)
{
    return find_one(rows, thumbprint,
                    [](const RevocationRow& row) { return row.revocations.thumbprint_text(); });
}

} // namespace busbar::tool::admin
