# The program alone, without a system around it: docker run --rm -v "$PWD:/data" rackmesh eval rack.toml
FROM rust:1.95 AS build
WORKDIR /rackmesh
COPY . .
ENV RUSTFLAGS="-C target-feature=+crt-static"
RUN target=$(rustc -vV | sed -n 's/^host: //p') \
 && cargo build --release --locked --target "$target" \
 && cp "target/$target/release/rackmesh" /rackmesh-static

FROM scratch
COPY --from=build /rackmesh-static /rackmesh
WORKDIR /data
ENTRYPOINT ["/rackmesh"]
