# loop_levels.R FOLDER: restricted likelihood by nlme of every FOLDER/*.csv, y ~ heat with random levels of cask (where there
# is a batch: within batch), as a list of sd between levels, sd within, the slope over heat and its standard error (with a
# batch: its sd first). Writes FOLDER/lme.txt.
suppressPackageStartupMessages(library(nlme))
folder <- commandArgs(trailingOnly = TRUE)[1]
lines <- character()
for (path in sort(list.files(folder, "\\.csv$", full.names = TRUE))) {
  table <- read.csv(path)
  nested <- "batch" %in% names(table)
  fit <- if (nested) lme(y ~ heat, random = ~ 1 | batch / cask, data = table) else lme(y ~ heat, random = ~ 1 | cask, data = table)
  sd <- as.numeric(VarCorr(fit)[if (nested) c(2, 4, 5) else 1:2, "StdDev"])
  lines <- c(lines, paste(c(basename(path), sd, fixef(fit)[["heat"]], sqrt(vcov(fit)["heat", "heat"])), collapse = " "))
}
writeLines(lines, file.path(folder, "lme.txt"))
