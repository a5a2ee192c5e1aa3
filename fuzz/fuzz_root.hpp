#pragma once

#include <span>
#include <string_view>

#include <busbar/crypto/certificate_validator.hpp>

namespace busbar::test {

/// 2026-01-01, when the certificates of the corpus are valid.
inline constexpr DateTime fuzz_time = DateTime::from_unix_seconds(1'767'225'600);

/// A root that signed the certificates and the revocation lists of the corpus; nobody has its key.
inline const crypto::Certificate& fuzz_root()
{
    constexpr std::string_view pem = R"(
-----BEGIN CERTIFICATE-----
MIIC5zCCAc+gAwIBAgICA+kwDQYJKoZIhvcNAQELBQAwDzENMAsGA1UEAwwEcm9v
dDAeFw0yNTA5MjMwMDAwMDBaFw0yNjA0MTEwMDAwMDBaMA8xDTALBgNVBAMMBHJv
b3QwggEiMA0GCSqGSIb3DQEBAQUAA4IBDwAwggEKAoIBAQCoLkiXbdErVJkPxsga
PN6bUoQ3k1l/OKG7lv2tr14FdS0qv7tOLGRkQm7USKaUF5ktWDz3OA1UoJH/yA3h
d88ADgclBBcdkijq/YMUjSfPwMwgulriperm6gwEXTyHrNchgnSc490qK3lKEceD
ngnzsG8GeMDiOTFLEktWdq27KyA8jMe7ss9q+FK0TLGnGb3jFe8hi+xxOge2FB3x
BG/2c65Rl5ZUs4vZWBL39WLVQnnDXqDSGt22ybnT8knnx///LR6F3qX4U7qGSxu6
cg2tFDOXysXdBywm+COXbjNQ8zkF2TfNAZ+EwMEAucXPD2ndRgs9OPpb4PFigt0V
k+TTAgMBAAGjTTBLMB0GA1UdDgQWBBQUofD/GeOR/S9F7dixOUoe4rfhRjAJBgNV
HSMEAjAAMA8GA1UdEwEB/wQFMAMBAf8wDgYDVR0PAQH/BAQDAgEGMA0GCSqGSIb3
DQEBCwUAA4IBAQBVINf0398Tcbl2Cd3iMeXXk0m5Wm8sbK0USQoU0ti/Yj6J0UwH
g6gtCYtAsFbyeaPuvUP/Rw+iEA3va70w5QyrSkQYPDxKUQdCgcTeITwSjdOLfgqi
2tKfcNZooM7dy1kp4Yxf3qY3AUu/JtLYWiM90ntFu+ZgZB+9aSDn+BLVBUUbM2/8
D+QeW0WKenLrzWSHW+vYPXF3zU2yD+sCqenqc0SERsPp0CjnmTMx65IcmWyrCSt+
qENn4P8lvdbfqW5HuthEWVpjWGrIXev3fXaw2V6zPc2cdnlzCZbWr+sh8EeDYO2/
8IKwpZFsntJUWVIgoTOHnDmU/vI6vIidE3f2
-----END CERTIFICATE-----
)";
    static const crypto::Certificate root =
        *crypto::Certificate::parse_file(std::as_bytes(std::span{pem}));
    return root;
}

} // namespace busbar::test
