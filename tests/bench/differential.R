# One random design after the other: fitted by lm and by the program `dump`, every number compared.
arguments <- commandArgs(trailingOnly = TRUE)
count <- as.integer(arguments[1])
work <- arguments[2]
report <- if (length(arguments) > 2) arguments[3] else ""
tolerance <- 1e-9

two_level <- function() {
  k <- sample(2:4, 1)
  d <- expand.grid(rep(list(c(-1, 1)), k))
  names(d) <- paste0("x", 1:k)
  d[rep(seq_len(nrow(d)), sample(1:3, 1)), , drop = FALSE]
}
composite <- function() {
  d <- rbind(two_level()[, 1:2], data.frame(x1 = c(-1.5, 1.5, 0, 0, 0, 0, 0),
                                            x2 = c(0, 0, -1.5, 1.5, 0, 0, 0)))
  d
}
scattered <- function() {
  n <- sample(8:40, 1)
  as.data.frame(sapply(c(x1 = 1, x2 = 10, x3 = 0.01), function(s) signif(runif(n, -s, s), 6)))
}
random_formula <- function(d) {
  numbers <- grep("^x", names(d), value = TRUE)
  factors <- grep("^g", names(d), value = TRUE)
  first <- c(factors, numbers)
  pairs <- if (length(first) > 1) combn(first, 2, paste, collapse = ":") else character()
  squares <- paste0(numbers, "^2")
  second <- c(squares, pairs)
  chosen <- c(sample(first, sample(seq_along(first), 1)),
              if (length(second)) sample(second, sample(0:min(4, length(second)), 1)))
  constant <- if (runif(1) < 0.15) "0" else "1"
  paste(c(constant, chosen), collapse = " + ")
}
to_r <- function(text) gsub("(x[0-9]+)\\^2", "I(\\1^2)", text)

reference <- function(d, text) {
  model <- lm(terms(as.formula(paste("y ~", to_r(text))), keep.order = TRUE), d, tol = 1e-10)
  freedom <- model$df.residual
  s <- summary(model)
  table <- matrix(NA, length(coef(model)), 4)
  table[!is.na(coef(model)), ] <- s$coefficients
  half <- qt(0.975, freedom) * table[, 2]
  a <- anova(model)
  a <- a[-nrow(a), , drop = FALSE]
  hat <- hatvalues(model)
  cells <- c(t(cbind(table, table[, 1] - half, table[, 1] + half)))
  names(cells) <- rep(c("coef", "se", "t", "p", "low", "high"), nrow(table))
  rows <- c(t(cbind(a[, 2], a[, 1], a[, 4], a[, 5])))
  names(rows) <- rep(c("seq_ss", "seq_df", "seq_f", "seq_p"), nrow(a))
  f <- if (is.null(s$fstatistic)) NaN else s$fstatistic[1]
  named <- function(v, name) setNames(unname(v), rep(name, length(v)))
  c(cells, rank = model$rank, rss = deviance(model), sigma = s$sigma, r2 = s$r.squared,
    adj = s$adj.r.squared, f = unname(f), press = sum((residuals(model) / (1 - hat))^2), rows,
    named(fitted(model), "fitted"), named(hat, "hat"), named(rstandard(model), "rstandard"),
    named(rstudent(model), "rstudent"), named(cooks.distance(model), "cook"))
}

# Numbers of one kind share a scale: a residual near zero is judged beside its neighbours.
worst_difference <- function(ours, theirs) {
  kinds <- names(theirs)
  scale <- ave(abs(theirs), kinds, FUN = function(v) max(v[is.finite(v)], 0))
  scale[kinds == "p" | kinds == "seq_p"] <- pmax(abs(theirs[kinds == "p" | kinds == "seq_p"]), 1e-12)
  difference <- abs(ours - theirs) / pmax(scale, 1e-300)
  difference[is.nan(ours) & !is.finite(theirs)] <- 0
  difference[ours == theirs] <- 0
  i <- which.max(ifelse(is.na(difference), Inf, difference))
  list(value = if (is.na(difference[i])) Inf else difference[i], kind = kinds[i],
       ours = ours[i], theirs = theirs[i])
}

rows <- list()
done <- 0
seed <- 0
while (done < count) {
  seed <- seed + 1
  set.seed(seed)
  d <- list(two_level, composite, scattered)[[sample(3, 1)]]()
  if (runif(1) < 0.5) d$g <- sample(letters[1:sample(2:4, 1)], nrow(d), replace = TRUE)
  if (runif(1) < 0.2) d$x9 <- d$x1 + 2 * d$x2
  if (!is.null(d$g) && length(unique(d$g)) < 2) next
  text <- random_formula(d)
  # Without the constant R gives the first factor all its levels, even where x + x:g makes one of
  # them redundant; the program does not: same model, other columns.
  if (grepl("^0", text) && grepl("g", text) && !grepl("\\+ g( |$)", text)) next
  d$y <- signif(rnorm(nrow(d), 10 * runif(1), 1) + 3 * d$x1, 8)
  theirs <- suppressWarnings(try(reference(d, text), silent = TRUE))
  # Runs that determine a coefficient alone are NaN by design here, and 0/0 in R.
  if (inherits(theirs, "try-error") || any(theirs[names(theirs) == "hat"] > 1 - 1e-8) ||
      nrow(d) - theirs["rank"] < 2) next
  csv <- file.path(work, "data.csv")
  d[] <- lapply(d, function(v) if (is.numeric(v)) sprintf("%.17g", v) else v)
  write.csv(d, csv, row.names = FALSE, quote = FALSE)
  output <- system2(file.path(work, "dump"), c(csv, shQuote(text)), stdout = TRUE)
  parts <- strsplit(output, " ")
  ours <- setNames(as.numeric(sapply(parts, `[`, 2)), sapply(parts, `[`, 1))
  if (length(ours) != length(theirs) || any(names(ours) != names(theirs)))
    stop("seed ", seed, ", ", text, ": other numbers than R gives")
  worst <- worst_difference(ours, theirs)
  if (worst$value > tolerance) {
    cat(sprintf("seed %d, %s: %s %.17g, R %.17g\n", seed, text, worst$kind, worst$ours, worst$theirs))
    quit(status = 1)
  }
  done <- done + 1
  rows[[done]] <- data.frame(seed = seed, runs = nrow(d), columns = sum(names(theirs) == "coef"),
                             aliased = sum(names(theirs) == "coef") - theirs["rank"],
                             numbers = length(theirs), worst_difference = signif(worst$value, 2))
}
all <- do.call(rbind, rows)
if (nzchar(report)) write.csv(all, report, row.names = FALSE, quote = FALSE)
cat(sprintf("%d designs, %d numbers, %d designs with aliases: worst difference from R %.1e\n",
            nrow(all), sum(all$numbers), sum(all$aliased > 0), max(all$worst_difference)))
