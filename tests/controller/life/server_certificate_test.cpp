#include <catch2/catch.hpp>

#include <array>

#include <busbar/core/record.hpp>
#include <busbar/crypto/certificate_notices.hpp>
#include <busbar/crypto/own_certificate.hpp>

#include "logged_life.hpp"

namespace server_certificate_test {

// The server certificate from the first start of a controller to its renewal.

using namespace busbar;
using namespace busbar::controller;
using busbar::test::LoggedLife;
using busbar::test::Texts;

namespace {

/// What 3-2-4 and 3-2-5 have for a controller at this address.
crypto::OwnCertificateSettings certificate_at(const std::string& address, std::uint32_t years)
{
    crypto::OwnCertificateSettings settings;
    settings.subject = {.common_name = "NxOpcUaServer@" + address,
                        .organization = "Press Works",
                        .locality = "Kyoto",
                        .state = "Kyoto",
                        .country = "JP",
                        .application_uri = "urn:machine"};
    settings.subject.valid_days = years * 365;
    crypto::add_host(settings.subject, address);
    return settings;
}

struct CertificateLife : LoggedLife {
    void look(const crypto::OwnCertificate& own, const std::string& address)
    {
        static_cast<void>(watch.check(own.certificates.front(), clock.time, std::array{address}));
    }
    void tell_updated(const crypto::OwnCertificate& own)
    {
        Record record{RecordKind::CertificateUpdated};
        record.certificate = own.certificates.front().der();
        tell(*log, record);
    }

    crypto::OwnCertificateStore store{memory};
    crypto::CertificateWatch watch{*log};
};

const std::string first_address = "192.168.250.1";
const std::string other_address = "192.168.250.2";

} // namespace

TEST_CASE_METHOD(CertificateLife, "A server certificate is made where there is none (3-2-4)")
{
    const auto settings = certificate_at(first_address, 20);
    REQUIRE_FALSE(store.load()->has_value());
    const auto made = store.load_or_create(settings, clock.time);
    REQUIRE(made);
    const auto subject = crypto::subject_of(made->certificates.front());
    CHECK(subject.common_name == "NxOpcUaServer@192.168.250.1");
    CHECK(subject.ip_addresses == std::vector<std::string>{first_address});
    look(*made, first_address);
    CHECK(events().empty());

    // There is one at the next start, also at another address: it stays, and does not match.
    const auto again = store.load_or_create(certificate_at(other_address, 20), clock.time);
    REQUIRE(again);
    CHECK(again->certificates.front() == made->certificates.front());
    look(*again, other_address);
    CHECK(events() == Texts{"15020000"});
    CHECK(logged() == Texts{"CERT 0004 Mismatch_Host NxOpcUaServer@192.168.250.1 "
                            "2037-10-12T14:52:50Z"});
}

TEST_CASE_METHOD(CertificateLife, "A server certificate is shown, exported and renewed (3-2-5)")
{
    const auto old = store.load_or_create(certificate_at(first_address, 20), clock.time);
    REQUIRE(old);
    start();
    server.calls.clear();
    look(*old, other_address);
    CHECK(event_log->current_errors().size() == 1);

    const auto renewed = store.regenerate(certificate_at(other_address, 1), clock.time);
    REQUIRE(renewed);
    tell_updated(*renewed);
    life.certificate_renewed();
    CHECK(server.take() == Texts{"reconfigure 4840"});
    CHECK(event_log->current_errors().empty());
    look(*renewed, other_address);
    CHECK(events() == Texts{"95D00000", "15020000", "95D20000"});
    CHECK(logged()[4] == "CERT 0001 Update_Server NxOpcUaServer@192.168.250.2 "
                         "2018-10-17T14:52:50Z");

    const auto exported = crypto::read_certificates(renewed->certificates.front().der());
    REQUIRE(exported);
    const crypto::Certificate& shown = exported->front();
    CHECK(shown.host_names() == std::vector<std::string>{other_address});
    CHECK_FALSE(shown == old->certificates.front());
    const auto subject = crypto::subject_of(shown);
    CHECK(subject.common_name == "NxOpcUaServer@192.168.250.2");
    CHECK(subject.organization == "Press Works");
    CHECK(subject.locality == "Kyoto");
    CHECK(subject.state == "Kyoto");
    CHECK(subject.country == "JP");
    CHECK(store.load("urn:machine").value()->certificates.front() == shown);
}

} // namespace server_certificate_test
