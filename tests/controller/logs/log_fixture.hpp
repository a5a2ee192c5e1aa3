#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include <busbar/controller/execution_log_record.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/self_signed.hpp>

#include "support/kept_key.hpp"

/// Records as the layers tell them, that live as long as the test needs.
namespace busbar::test {

/// 2017-10-17T14:52:50.747Z, when the examples of W588, 7-1-7 begin.
inline constexpr DateTime example_start{DateTime::from_unix_seconds(1'508'251'970).ticks +
                                        7'470'000};

inline DateTime later(DateTime time, std::int64_t milliseconds)
{
    return {time.ticks + milliseconds * 10'000};
}

/// A record that owns what it refers to.
struct Happening {
    explicit Happening(RecordKind kind, std::vector<RecordField> its_fields = {})
        : fields{std::move(its_fields)}, what{kind}
    {
    }

    Happening& with(StatusCode status)
    {
        what.status = status;
        return *this;
    }
    Happening& of(std::span<const std::byte> certificate)
    {
        what.certificate = certificate;
        return *this;
    }
    Happening& by(std::string_view user, NodeId session = NodeId{1, 0x2ADA356BU},
                  std::string_view address = "192.168.255.2")
    {
        session_id = std::move(session);
        what.actor.user = user;
        what.actor.address = address;
        return *this;
    }

    [[nodiscard]] Record record() const
    {
        Record result = what;
        result.fields = fields;
        result.actor.session_id = session_id.is_null() ? nullptr : &session_id;
        return result;
    }

    std::vector<RecordField> fields;
    NodeId session_id;
    Record what;
};

inline RecordField text(std::string_view name, std::string value)
{
    return {name, Variant{String{std::move(value)}}};
}

inline RecordField number(std::string_view name, std::uint32_t value)
{
    return {name, Variant{value}};
}

inline Happening published(std::string name, std::uint32_t size, std::uint32_t values,
                           std::uint32_t members)
{
    return Happening{RecordKind::VariablePublished,
                     {text("Name", std::move(name)), number("Size", size), number("Values", values),
                      number("Members", members)}};
}

inline Happening refused_client()
{
    return Happening{RecordKind::CertificateRefused}.with(status::Bad_CertificateUntrusted);
}

/// Made once: keys take their time.
inline const crypto::PrivateKey& test_key()
{
    static const crypto::PrivateKey key = kept_key("log", 2048);
    return key;
}

/// Valid from `from` for so many days.
inline crypto::Certificate certificate_of(std::string common_name, DateTime from,
                                          std::uint32_t days)
{
    crypto::CertificateSubject subject;
    subject.common_name = std::move(common_name);
    subject.application_uri = "urn:sample:client";
    subject.dns_names = {"SamplePC"};
    subject.ip_addresses = {"192.168.250.1"};
    subject.valid_from = from;
    subject.valid_days = days;
    return crypto::create_self_signed(test_key(), subject).value();
}

/// That of the examples: until 2022-10-03T08:19:54Z.
inline const crypto::Certificate& sample_client()
{
    static const crypto::Certificate certificate = certificate_of(
        "UaClient_1@SamplePC", DateTime::from_unix_seconds(1'664'785'194 - 1826 * 86'400LL), 1826);
    return certificate;
}

} // namespace busbar::test
